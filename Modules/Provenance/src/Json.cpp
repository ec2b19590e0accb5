// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Provenance/Json.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/WholeFile.h"

#include <cmath>

namespace explica::provenance {
namespace {

Json elementToJson(double value) {
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  return value;
}
Json elementToJson(bool value) {
  return value;
}
Json elementToJson(int value) {
  return value;
}
Json elementToJson(const std::string& value) {
  return value;
}
template <int N>
Json elementToJson(const Eigen::Matrix<double, N, 1>& value) {
  Json array = Json::array();
  for (int i = 0; i < N; ++i) array.push_back(elementToJson(value[i]));
  return array;
}
template <class T>
Json elementToJson(const std::optional<T>& value) {
  return value ? elementToJson(*value) : Json(nullptr);
}
template <class T>
Json elementToJson(const std::vector<T>& values) {
  Json array = Json::array();
  for (const auto& value : values) array.push_back(elementToJson(value));
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

/// Empties an optional or a list.
void unset(Option& option) {
  std::visit(
      [&](auto& where) {
        if constexpr (std::is_same_v<std::decay_t<decltype(where)>, ChoiceTarget>) {
          where.set({});
        } else if constexpr (requires { where->reset(); }) {
          where->reset();
        } else if constexpr (requires {
                               where->shrink_to_fit();
                               where->pop_back();
                             }) {
          where->clear();
        }
      },
      option.target);
}

}  // namespace

Json valueOf(const Option& option) {
  return std::visit(
      [](const auto& where) -> Json {
        if constexpr (std::is_same_v<std::decay_t<decltype(where)>, ChoiceTarget>) {
          const auto words = where.get();
          if (where.list) return words;
          return words.empty() ? Json(nullptr) : Json(words.front());
        } else {
          return elementToJson(*where);
        }
      },
      option.target);
}

void setValue(Option& option, const Json& value) {
  const bool isPoint = option.type() == "point2" || option.type() == "point3";
  const auto refuse = [&](const std::string& expected) {
    throw UsageError(option.name + ": " + textOf(value) + " is not " + expected);
  };
  if (value.is_null()) {
    if (!option.isOptional()) refuse("a value for this option");
    unset(option);
  } else if (value.is_object()) {
    refuse("a value for this option");
  } else if (option.isList() && value.is_array()) {
    if (value.empty()) {
      unset(option);
      return;
    }
    if (isPoint && !value.front().is_array()) {  // one point stands for a list of one
      option.setText({commaJoined(value)});
      return;
    }
    std::vector<std::string> words;
    for (const auto& element : value) {
      words.push_back(element.is_array() ? commaJoined(element) : wordOf(element));
    }
    option.setText(words);
  } else if (value.is_array()) {
    if (!isPoint) refuse("a single value");
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
