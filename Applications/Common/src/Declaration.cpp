// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Application/Declaration.h"

#include <algorithm>
#include <stdexcept>

namespace explica::app {

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

Parameter* Declaration::find(std::string_view wanted) {
  const auto found =
      std::ranges::find_if(parameters, [&](const Parameter& p) { return p.option.name == wanted; });
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
