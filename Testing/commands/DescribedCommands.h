// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Commands as `explica --describe` tells of them, so that tests try a new one by themselves.
#pragma once

#include "Explica/Testing/Command.h"

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace explica::testing {

using Json = nlohmann::ordered_json;

inline const Json& describedCommands() {
  static const Json all = Json::parse(explica({"--describe"}).out);
  return all;
}

/// "phantom", "shell" of phantom shell.
inline std::vector<std::string> wordsOf(const Json& command) {
  std::istringstream name(command["command"].get<std::string>());
  std::vector<std::string> words;
  for (std::string word; name >> word;) words.push_back(word);
  return words;
}

/// The parameter of that name, or null.
inline const Json& parameterOf(const Json& command, const std::string& name) {
  static const Json none;
  const Json& all = command["parameters"];
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Json& p) { return p["name"] == name; });
  return found == all.end() ? none : *found;
}

/// A word that the parser takes for a parameter's value.
inline std::string valueFor(const Json& p) {
  if (p["type"] == "choice") return p["choices"].back();
  if (p["type"] == "point3") return "1,0,0";
  if (p["type"] == "point2") return "1,2";
  if (p["type"] != "integer" && p["type"] != "number") return "word.png";
  const double least = p["least"].is_null() ? 1 : std::max(1.0, p["least"].get<double>());
  const double most = p["most"].is_null() ? least : p["most"].get<double>();
  std::ostringstream text;
  text << (least <= most ? least : most / 2);
  return text.str();
}

/// Adds what the options that a parameter needs are given by.
inline void appendNeeds(std::vector<std::string>& words, const Json& command, const Json& p,
                        std::set<std::string>& given) {
  if (p["needs"].empty()) return;
  const std::string condition = p["needs"].front();
  const auto at = condition.find('=');
  const std::string name = condition.substr(0, at);
  if (!given.insert(name).second) return;
  words.push_back("--" + name);
  const Json& needed = parameterOf(command, name);
  if (at != std::string::npos) {
    words.push_back(condition.substr(at + 1));
  } else if (needed["type"] != "flag") {
    words.push_back(valueFor(needed));
  }
}

}  // namespace explica::testing
