// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "ReportParts.h"

#include <algorithm>
#include <map>

namespace explica::pipeline {
namespace {

/// A value of a summary as people read it, without its unit.
std::string textOf(const Json& value, const std::string& unit) {
  return value.is_number() ? shown(value.get<double>(), unit).text : readable(value);
}

/// What the record says of the numbers that belong at the head of a page.
void listDescribed(const ResultFolder& results, const std::vector<std::string>& sides,
                   report::ReportFindings& findings) {
  std::map<std::pair<std::string, std::string>, std::size_t> rows;  // by command and key
  const bool isMany = results.steps().size() > 1;
  for (const StepFolder& step : results.steps()) {
    // The thickness is stated once: that of the surfaces where there are any.
    if (step.command == "thickness" && !results.stepsOf("surface").empty()) continue;
    const Json meanings = step.record.value("meanings", Json::object());
    for (const auto& [key, meaning] : meanings.items()) {
      if (!meaning.value("head", false) || !step.summary.contains(key)) continue;
      const std::string unit = meaning.value("unit", ""), start = meaning.value("start", "");
      const auto [row, isNew] = rows.try_emplace({step.command, key}, findings.rows.size());
      if (isNew) {
        findings.rows.push_back({meaning.value("title", key), shown(0, unit).unit,
                                 std::vector<std::string>(step.side().empty() ? 1 : sides.size()),
                                 meaning.value("meaning", ""), meaning.value("expected", ""),
                                 isMany ? inWords(step.command) : ""});
      }
      std::string text = textOf(step.summary[key], unit);
      if (step.summary.contains(start)) {
        text = textOf(step.summary[start], unit) + " \u2192 " + text;
      }
      std::vector<std::string>& values = findings.rows[row->second].values;
      for (std::size_t n = 0; n < values.size(); ++n) {
        if (values.size() == 1 || step.side() == sides[n]) values[n] = text;
      }
    }
  }
}

/// Numbers of a command that has no rows of its own in the table.
void listOwnNumbers(const StepFolder& step, report::ReportFindings& findings) {
  for (const auto& [key, value] : step.summary.items()) {
    if (findings.rows.size() >= 12) return;
    if (!value.is_number() || key.starts_with("seconds") || key == "peak_memory_bytes") continue;
    findings.rows.push_back({inWords(key), "", {readable(value)}});
  }
}

}  // namespace

void findNumbers(ResultFolder& results) {
  report::ReportFindings& findings = results.content().findings;
  std::vector<std::string> sides;
  for (const StepFolder& step : results.steps()) {
    if (!step.side().empty() && std::ranges::find(sides, step.side()) == sides.end()) {
      sides.push_back(step.side());
    }
  }
  std::ranges::sort(sides);
  if (sides.size() < 2) sides = {""};
  findings.columns = sides;
  listDescribed(results, sides, findings);
  if (findings.rows.empty() && results.steps().size() == 1) {
    listOwnNumbers(results.steps().front(), findings);
  }
}

}  // namespace explica::pipeline
