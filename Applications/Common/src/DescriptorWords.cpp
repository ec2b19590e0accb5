// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "DescriptorWords.h"

#include "Parse.h"

#include "Explica/Core/Text.h"

#include <algorithm>
#include <cctype>

namespace explica::app {
namespace {

std::string valueText(const Json& value) {
  if (value.is_null()) return "";
  if (value.is_string()) return word(value);
  if (value.is_array()) return joined(value, ",", valueText);
  return value.dump();
}

}  // namespace

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
  return text;
}

bool takesFile(const Json& p) {
  return !p["file"].is_null() && p["file"] != "folder";
}
bool takesFolder(const Json& p) {
  return p["file"] == "folder";
}
bool isFlag(const Json& p) {
  return p["type"] == "flag";
}
std::string word(const Json& value) {
  return value.get<std::string>();
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
