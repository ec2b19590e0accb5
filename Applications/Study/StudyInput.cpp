// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "StudyInput.h"

#include "Explica/Application/Command.h"
#include "Explica/Core/Errors.h"

#include <set>

namespace explica::app {
namespace {

using provenance::Json;

/// Options of `explica run` that the study itself decides.
const std::set<std::string> kOurs = {"atlas", "hemisphere", "resume"};

Json schemaOf(const provenance::Option& option) {
  static const std::map<std::string, const char*> types = {
      {"flag", "boolean"}, {"integer", "integer"}, {"number", "number"}, {"text", "string"}};
  Json one;
  const std::string type = option.type;
  if (type == "choice") {
    one["enum"] = option.choices;
  } else if (type == "point2" || type == "point3") {
    const int size = type == "point2" ? 2 : 3;
    one = {
        {"type", "array"}, {"minItems", size}, {"maxItems", size}, {"items", {{"type", "number"}}}};
  } else {
    one["type"] = types.at(type);
  }
  const Json element = one;
  if (option.isList) one = {{"type", "array"}, {"items", element}};
  if (option.isList && element.contains("maxItems")) {
    one = {{"anyOf", {element, one}}};  // one point stands for a list of one
  }
  one["description"] = option.help + (option.unit.empty() ? "" : ", in " + option.unit);
  return one;
}

const Declaration& declarationOf(const char* name) {
  static std::map<std::string, Invocation> known;
  const auto found = known.find(name);
  if (found != known.end()) return found->second.declaration;
  const Command* command = findCommand(name);
  if (!command)
    throw EnvironmentError(std::string("explica ") + name + " is not part of this build");
  return known.emplace(name, command->begin()).first->second.declaration;
}

}  // namespace

Json studyFileSchema() {
  Json parameters = Json::object(), region = Json::object();
  for (const Parameter& parameter : declarationOf("run").parameters) {
    if (parameter.positional || kOurs.count(parameter.option.name)) continue;
    parameters[parameter.option.name] = schemaOf(parameter.option);
  }
  for (const Parameter& parameter : declarationOf("unfold").parameters) {
    const std::string& category = parameter.option.category;
    if (!parameter.positional && (category == "View" || category == "Region")) {
      region[parameter.option.name] = schemaOf(parameter.option);
    }
  }
  return study::studySchema(parameters, region);
}

study::PathOptions studyPathOptions() {
  study::PathOptions paths;
  for (const Parameter& parameter : declarationOf("run").parameters) {
    if (parameter.file && !parameter.positional) paths.insert(parameter.option.name);
  }
  return paths;
}

study::StudyFile readCheckedStudy(const std::string& path) {
  study::StudyFile file = study::readStudyFile(path);
  study::checkStudyFile(file, studyFileSchema());
  return file;
}

}  // namespace explica::app
