// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Declaration.h"

#include <algorithm>
#include <stdexcept>

namespace explica::app {

using provenance::makeOption;

Declaration& Declaration::synopsis(std::string line) {
  synopsisText = std::move(line);
  return *this;
}

Declaration& Declaration::description(std::string text) {
  descriptionText = std::move(text);
  return *this;
}

Declaration& Declaration::reference(std::string citation) {
  references.push_back(std::move(citation));
  return *this;
}

Declaration& Declaration::example(std::string commandLine, std::string what) {
  examples.push_back({std::move(commandLine), std::move(what)});
  return *this;
}

Declaration& Declaration::input(const std::string& inputName, FileKind kind,
                                const std::string& help, std::string& path) {
  return add(makeOption(Field{inputName, "", help}, path), "", true, true, kind);
}

Declaration& Declaration::input(const std::string& inputName, FileKind kind,
                                const std::string& help, std::optional<std::string>& path) {
  return add(makeOption(Field{inputName, "", help}, path), "", true, false, kind);
}

Declaration& Declaration::input(const std::string& inputName, FileKind kind,
                                const std::string& help, std::vector<std::string>& paths) {
  return add(makeOption(Field{inputName, "", help}, paths), "", true, true, kind);
}

Declaration& Declaration::inputOption(const std::string& optionName, FileKind kind,
                                      const std::string& help, std::optional<std::string>& path,
                                      const std::string& category) {
  return add(makeOption(Field{optionName, "", help}, path), category, false, false, kind);
}

Declaration& Declaration::inputOption(const std::string& optionName, FileKind kind,
                                      const std::string& help, std::vector<std::string>& paths,
                                      const std::string& category) {
  return add(makeOption(Field{optionName, "", help}, paths), category, false, false, kind);
}

Declaration& Declaration::severalWords(std::string_view wanted) {
  Parameter& parameter = get(wanted);
  if (!parameter.option.isList()) {
    throw std::logic_error("severalWords: no list option " + std::string(wanted));
  }
  parameter.severalWords = true;
  return *this;
}

Declaration& Declaration::namesOutput(std::string_view wanted) {
  get(wanted).namesOutput = true;
  return *this;
}

Declaration& Declaration::ofSide(std::string_view wanted, Hemisphere side) {
  get(wanted).side = side;
  return *this;
}

Declaration& Declaration::ofAnother(std::string_view wanted, const bool& mirrored) {
  get(wanted).ofAnother = &mirrored;
  return *this;
}

Declaration& Declaration::oneByOne(std::string_view wanted) {
  get(wanted).oneByOne = true;
  return *this;
}

Declaration& Declaration::excludes(const std::string& one, const std::vector<std::string>& others) {
  for (const std::string& other : others) {
    get(one).excludes.push_back(get(other).option.name);
    get(other).excludes.push_back(one);
  }
  return *this;
}

Declaration& Declaration::needs(const std::vector<std::string>& names,
                                const std::vector<std::string>& conditions) {
  for (const std::string& condition : conditions) {
    static_cast<void>(get(condition.substr(0, condition.find('='))));
  }
  for (const std::string& one : names) get(one).needs = conditions;
  return *this;
}

Declaration& Declaration::require(std::string_view wanted) {
  get(wanted).required = true;
  return *this;
}

Declaration& Declaration::without(std::string_view unwanted) {
  std::erase_if(parameters, [&](const Parameter& p) { return p.option.name == unwanted; });
  return *this;
}

Declaration& Declaration::include(const Declaration& other, std::string_view prefix) {
  for (const Parameter& parameter : other.parameters) {
    if (parameter.positional) continue;
    Parameter copy = parameter;
    copy.option.name = std::string(prefix) + copy.option.name;
    copy.option.category = other.name + ": " + copy.option.category;
    if (copy.stepCommand.empty()) copy.stepCommand = other.name;
    copy.stepPrefix = std::string(prefix) + copy.stepPrefix;
    copy.required = false;
    copy.needs.clear();  // who takes the options over may see to it by itself
    for (std::string& beside : copy.excludes) beside = std::string(prefix) + beside;
    if (find(copy.option.name)) throw std::logic_error("declared twice: " + copy.option.name);
    parameters.push_back(std::move(copy));
  }
  return *this;
}

Declaration& Declaration::output(std::string pattern, FileKind kind, std::string help) {
  outputs.push_back({std::move(pattern), kind, std::move(help), false});
  return *this;
}

Declaration& Declaration::varyingOutput(std::string pattern, FileKind kind, std::string help) {
  outputs.push_back({std::move(pattern), kind, std::move(help), true});
  return *this;
}

Declaration& Declaration::withoutOutput() {
  writesOutput = false;
  return *this;
}

Declaration& Declaration::inPlace() {
  writesInPlace = true;
  return *this;
}

Declaration& Declaration::writesThrough() {
  handsOutputOn = true;
  return *this;
}

Declaration& Declaration::reuseOutputIf(const bool& flag) {
  reuse = &flag;
  return *this;
}

Declaration& Declaration::shareOfWork(std::function<std::string()> shareName) {
  share = std::move(shareName);
  return *this;
}

Declaration& Declaration::defaultOut(const std::string& folder) {
  fallbackOut = &folder;
  return *this;
}

Parameter* Declaration::find(std::string_view wanted) {
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&](const Parameter& p) { return p.option.name == wanted; });
  return found == parameters.end() ? nullptr : &*found;
}

const Parameter* Declaration::find(std::string_view wanted) const {
  return const_cast<Declaration*>(this)->find(wanted);
}

Parameter& Declaration::get(std::string_view wanted) {
  Parameter* parameter = find(wanted);
  if (!parameter) throw std::logic_error("no option or positional " + std::string(wanted));
  return *parameter;
}

Declaration& Declaration::add(provenance::Option option, const std::string& category,
                              bool positional, bool required, std::optional<FileKind> file) {
  if (find(option.name)) throw std::logic_error("declared twice: " + option.name);
  option.category = category;
  Parameter parameter;
  parameter.defaultText = positional ? std::string() : option.text();
  parameter.option = std::move(option);
  parameter.file = file;
  parameter.positional = positional;
  parameter.required = required;
  parameters.push_back(std::move(parameter));
  return *this;
}

}  // namespace explica::app
