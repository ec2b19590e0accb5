// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Options that need, exclude or miss each other.

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Parse.h"
#include "Wording.h"

#include <algorithm>

namespace explica::app {
namespace {

/// Whether a condition of Declaration::needs holds: "label" is given, "method=thesis" is its value.
bool holds(const Declaration& declaration, const std::set<std::string>& given,
           const std::string& condition) {
  const auto equals = condition.find('=');
  if (equals == std::string::npos) return given.count(condition) > 0;
  const Parameter* parameter = declaration.find(condition.substr(0, equals));
  return parameter && parameter->option.text() == condition.substr(equals + 1);
}

/// "--method thesis" of "method=thesis".
std::string conditionText(const Declaration& declaration, const std::string& condition) {
  const auto equals = condition.find('=');
  const Parameter* parameter = declaration.find(condition.substr(0, equals));
  if (equals == std::string::npos) return dashed(*parameter);
  return dashed(*parameter) + " " + condition.substr(equals + 1);
}

}  // namespace

std::string needsText(const Declaration& declaration, const Parameter& parameter) {
  return joined(parameter.needs, " or ", [&](const std::string& condition) {
    return conditionText(declaration, condition);
  });
}

void requireSomething(const Declaration& declaration, const std::set<std::string>& given) {
  const bool reads = std::any_of(declaration.parameters.begin(), declaration.parameters.end(),
                                 [](const Parameter& p) { return p.file.has_value(); });
  if (!reads || !given.empty()) return;
  throw UsageError("nothing is given to work on; usage: " + usageLine(declaration) +
                   " (see --help)");
}

void refuseIgnored(const Declaration& declaration, const std::set<std::string>& given) {
  for (const Parameter& parameter : declaration.parameters) {
    if (!given.count(parameter.option.name)) continue;
    for (const std::string& other : parameter.excludes) {
      const Parameter* beside = declaration.find(other);
      if (!beside || !given.count(other)) continue;
      throw UsageError(dashed(parameter) + " and " + dashed(*beside) +
                       " exclude each other: leave one of them out");
    }
    const bool effective =
        parameter.needs.empty() ||
        std::any_of(parameter.needs.begin(), parameter.needs.end(),
                    [&](const auto& condition) { return holds(declaration, given, condition); });
    if (!effective) {
      throw UsageError(dashed(parameter) + " has no effect without " +
                       needsText(declaration, parameter) + ": leave it out, or add that");
    }
  }
}

void requireGiven(const Declaration& declaration, const std::set<std::string>& given) {
  for (const Parameter& parameter : declaration.parameters) {
    if (parameter.required && !given.count(parameter.option.name)) {
      throw UsageError(dashed(parameter) + " is missing: " + parameter.option.help);
    }
  }
}

}  // namespace explica::app
