// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "DescriptorWords.h"

#include <cctype>

namespace explica::app {
namespace {

Json boutiquesInput(const Json& p) {
  Json input = Json::object();
  const std::string id = identifier(word(p["name"]));
  input["id"] = id;
  input["name"] = word(p["name"]);
  // Not as "default-value": platforms would then pass every default as if the user had asked for
  // it.
  input["description"] = helpWithDefault(p);
  input["type"] = isFlag(p) ? "Flag" : isFile(p) ? "File" : isNumber(p) ? "Number" : "String";
  input["optional"] = isFlag(p) || !needed(p);
  std::string key;
  for (const char c : id) key += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  input["value-key"] = "[" + key + "]";
  if (!p["positional"]) input["command-line-flag"] = "--" + word(p["name"]);
  if (p["type"] == "integer") input["integer"] = true;
  if (!p["least"].is_null()) input["minimum"] = p["least"];
  if (!p["above"].is_null()) {
    input["minimum"] = p["above"];
    input["exclusive-minimum"] = true;
  }
  if (!p["most"].is_null()) input["maximum"] = p["most"];
  if (!p["choices"].empty()) input["value-choices"] = p["choices"];
  if (p["list"]) {
    input["list"] = true;
    if (isJoined(p)) input["list-separator"] = ",";
    if (!isJoined(p) && !p["positional"]) input["command-line-flag-separator"] = " ";
  }
  return input;
}

}  // namespace

Json boutiquesOf(const Json& command, const std::string& version) {
  const std::string name = word(command["command"]);
  Json descriptor = Json::object();
  descriptor["name"] = "explica " + name;
  const std::string description = word(command["description"]);
  descriptor["description"] = description.empty() ? word(command["synopsis"]) : description;
  descriptor["tool-version"] = version;
  descriptor["schema-version"] = "0.5";
  std::string line = "explica " + name;
  descriptor["inputs"] = Json::array();
  for (const bool positional : {true, false}) {
    for (const Json& p : command["parameters"]) {
      if (p["positional"].get<bool>() != positional) continue;
      descriptor["inputs"].push_back(boutiquesInput(p));
      line += " " + word(descriptor["inputs"].back()["value-key"]);
    }
  }
  descriptor["command-line"] = line;
  if (command["writes_folder"] && !command["outputs"].empty()) {
    descriptor["output-files"] = Json::array();
    for (const Json& slot : command["outputs"]) {
      const std::string pattern = word(slot["pattern"]);
      descriptor["output-files"].push_back({{"id", identifier(pattern)},
                                            {"name", pattern},
                                            {"description", word(slot["help"])},
                                            {"path-template", "[OUT]/" + pattern},
                                            {"optional", true}});
    }
  }
  descriptor["error-codes"] = Json::array();
  for (const auto& [code, meaning] : kExitCodes) {
    if (code != 0) descriptor["error-codes"].push_back({{"code", code}, {"description", meaning}});
  }
  descriptor["tags"] = {{"domain", {"neuroinformatics", "mri"}}};
  return descriptor;
}

}  // namespace explica::app
