// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Json.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"

#include <charconv>
#include <cmath>

namespace explica::provenance {
namespace {

Json numberOf(const std::string& word) {
  double value = 0;
  std::from_chars(word.data(), word.data() + word.size(), value);
  return std::isinf(value) ? Json(word) : Json(value);
}

Json elementOf(const Option& option, const std::string& word) {
  if (option.isFlag()) return word == "true";
  if (option.type == "integer") return std::stoi(word);
  if (option.type == "number") return numberOf(word);
  if (!option.isPoint()) return word;
  Json array = Json::array();
  for (const std::string& part : cellsOf(word, ',')) array.push_back(numberOf(part));
  return array;
}

std::string wordOf(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  return textOf(value);
}

/// [1, 2, 3] as "1,2,3".
std::string commaJoined(const Json& array) {
  return joined(array, ",", wordOf);
}

}  // namespace

Json valueOf(const Option& option) {
  const std::vector<std::string> words = option.words();
  if (!option.isList) return words.empty() ? Json(nullptr) : elementOf(option, words.front());
  Json array = Json::array();
  for (const std::string& word : words) array.push_back(elementOf(option, word));
  return array;
}

void setValue(Option& option, const Json& value) {
  const auto refuse = [&](const std::string& expected) {
    throw UsageError(option.name + ": " + textOf(value) + " is not " + expected);
  };
  if (value.is_null()) {
    if (!option.isOptional) refuse("a value for this option");
    option.setWords(option, {});
  } else if (value.is_object()) {
    refuse("a value for this option");
  } else if (option.isList && value.is_array()) {
    if (value.empty()) {
      option.setWords(option, {});
      return;
    }
    if (option.isPoint() && !value.front().is_array()) {  // one point stands for a list of one
      option.setText({commaJoined(value)});
      return;
    }
    std::vector<std::string> words;
    for (const auto& element : value) {
      words.push_back(element.is_array() ? commaJoined(element) : wordOf(element));
    }
    option.setText(words);
  } else if (value.is_array()) {
    if (!option.isPoint()) refuse("a single value");
    option.setText({commaJoined(value)});
  } else {
    if (option.isFlag() && !value.is_boolean()) refuse("true or false");
    option.setText({wordOf(value)});
  }
}

Json flattenKeys(const Json& object) {
  Json flat = Json::object();
  for (const auto& [key, value] : object.items()) {
    if (value.is_object()) {
      const Json inner = flattenKeys(value);
      for (const auto& [innerKey, innerValue] : inner.items()) {
        flat[key + "." + innerKey] = innerValue;
      }
    } else {
      flat[key] = value;
    }
  }
  return flat;
}

void writeJson(const std::filesystem::path& path, const Json& value) {
  writeTextFile(path, textOf(value, 2) + "\n");
}

}  // namespace explica::provenance
