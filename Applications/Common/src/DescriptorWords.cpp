// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "DescriptorWords.h"

#include "Parse.h"

#include "Explica/Core/Text.h"

#include <algorithm>
#include <cctype>

namespace explica::app {

std::string identifier(const std::string& name, char joint) {
  std::string id;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c))) {
      id += c;
    } else if (!id.empty() && id.back() != joint) {
      id += joint;
    }
  }
  return id;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

bool isFile(const Json& p) {
  return !p["file"].is_null() && p["file"] != "folder";
}
bool isFolder(const Json& p) {
  return p["file"] == "folder";
}
bool isFlag(const Json& p) {
  return p["type"] == "flag";
}
bool isPoint(const Json& p) {
  return p["type"] == "point2" || p["type"] == "point3";
}
bool isNumber(const Json& p) {
  return p["type"] == "number" || p["type"] == "integer";
}
bool isJoined(const Json& p) {
  return p["list"] && p["file"].is_null() && p["type"] != "text" && !isPoint(p);
}

std::string word(const Json& value) {
  return value.get<std::string>();
}

std::string valueText(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return word(value);
  if (value.is_array()) return joined(value, ",", valueText);
  return value.dump();
}

std::string helpOf(const Json& p) {
  const std::string unit = word(p["unit"]);
  const std::string range = word(p["range"]);
  const std::string aside = unit + (unit.empty() || range.empty() ? "" : "; ") + range;
  return word(p["help"]) + (aside.empty() ? "" : " [" + aside + "]");
}

std::string helpWithDefault(const Json& p) {
  const std::string value = isFlag(p) ? "" : valueText(p["default"]);
  return helpOf(p) + (value.empty() ? "" : " (default " + value + ")");
}

bool needed(const Json& p) {
  return p["required"].get<bool>() || p["name"] == "out";
}

std::vector<std::string> categoriesOf(const Json& command) {
  std::vector<std::string> categories;
  for (const Json& p : command["parameters"]) {
    const std::string category = p["positional"] ? "Arguments" : word(p["category"]);
    if (std::find(categories.begin(), categories.end(), category) == categories.end()) {
      categories.push_back(category);
    }
  }
  return categories;
}

Json describeAllCommands() {
  Json all = Json::array();
  for (const Command& command : allCommands()) {
    all.push_back(describeJson(command.begin().declaration));
  }
  return all;
}

}  // namespace explica::app
