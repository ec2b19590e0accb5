// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "ReportParts.h"

#include <algorithm>
#include <array>
#include <map>

namespace explica::pipeline {
namespace {

/// How a number of a summary is shown.
enum class Shown { Plain, Percent, SquareCentimetres, Range };

/// A row of the table: where its number is found, and what it means.
struct Finding {
  const char* command;
  const char* key;
  const char* start;  ///< key of the value at the start, shown before it; or empty
  const char* what;
  const char* unit;
  Shown shown;
  const char* meaning;
};

// What the head of a page shows, in this order.
constexpr std::array kFindings = {
    Finding{"segment", "brain_volume_ml", "", "Brain volume", "ml", Shown::Plain,
            "Everything inside the brain mask."},
    Finding{"segment", "white_share", "", "White matter in it", "", Shown::Percent,
            "Shares of the brain's volume."},
    Finding{"segment", "grey_share", "", "Grey matter in it", "", Shown::Percent, ""},
    Finding{"segment", "csf_share", "", "Fluid in it", "", Shown::Percent, ""},
    Finding{"sample", "vertices", "", "Vertices", "", Shown::Plain, ""},
    Finding{"sample", "layers", "", "Layers", "", Shown::Plain, ""},
    Finding{"sample", "points", "", "Points", "", Shown::Plain, ""},
    Finding{"sample", "points_distance_max", "", "Farthest point from the cortex", "mm",
            Shown::Plain, "Of its nearest column from white to pial."},
    Finding{"sphere", "turned_over", "", "Faces turned over", "", Shown::Plain, ""},
    Finding{"sphere", "areal_log2_mean", "", "Change of areas, mean of |log2|", "", Shown::Plain,
            "Over the surface's area."},
    Finding{"sphere", "stretch_median", "", "Largest over smallest stretch, median", "",
            Shown::Plain, "Over the surface's area; 1 where angles are kept."},
    Finding{"sphere", "stretch_p95", "", "Largest over smallest stretch, 95th percentile", "",
            Shown::Plain, ""},
};

std::string shownAs(Shown shown, double value) {
  switch (shown) {
    case Shown::Percent:
      return percent(value);
    case Shown::SquareCentimetres:
      return readable(value / 100);
    default:
      return readable(value);
  }
}

std::string valueIn(const StepFolder& step, const Finding& finding) {
  const auto value = step.number(finding.key);
  if (!value) return "";
  const auto start = *finding.start != '\0' ? step.number(finding.start) : std::nullopt;
  const char* between = finding.shown == Shown::Range ? " to " : " \u2192 ";
  return (start ? shownAs(finding.shown, *start) + between : "") + shownAs(finding.shown, *value);
}

/// A value of a summary as people read it, without its unit.
std::string textOf(const Json& value, const std::string& unit) {
  return value.is_number() ? shown(value.get<double>(), unit).text : readable(value);
}

/// What the record says of the numbers that belong at the head of a page.
void listDescribed(const ResultFolder& results, const std::vector<std::string>& sides,
                   report::ReportFindings& findings) {
  std::map<std::pair<std::string, std::string>, std::size_t> rows;  // by command and key
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
                                 std::vector<std::string>(sides.size()),
                                 meaning.value("meaning", "")});
      }
      std::string text = textOf(step.summary[key], unit);
      if (step.summary.contains(start)) {
        text = textOf(step.summary[start], unit) + " \u2192 " + text;
      }
      for (std::size_t n = 0; n < sides.size(); ++n) {
        const bool here = sides[n].empty() || step.side().empty() || step.side() == sides[n];
        if (here) findings.rows[row->second].values[n] = text;
      }
    }
  }
}

/// Numbers of a command that has no rows of its own in the table.
void listOwnNumbers(const StepFolder& step, report::ReportFindings& findings) {
  constexpr std::size_t kMost = 12;  // rows
  for (const auto& [key, value] : step.summary.items()) {
    if (findings.rows.size() >= kMost) return;
    if (!value.is_number() || key.rfind("seconds", 0) == 0 || key == "peak_memory_bytes") continue;
    findings.rows.push_back({inWords(key), "", {readable(value)}});
  }
}

}  // namespace

void findNumbers(ResultFolder& results) {
  report::ReportFindings& findings = results.content().findings;
  std::vector<std::string> sides;
  for (const StepFolder& step : results.steps()) {
    if (!step.side().empty() && std::find(sides.begin(), sides.end(), step.side()) == sides.end()) {
      sides.push_back(step.side());
    }
  }
  std::sort(sides.begin(), sides.end());
  if (sides.size() < 2) sides = {""};
  findings.columns = sides;
  listDescribed(results, sides, findings);
  for (const Finding& finding : kFindings) {
    report::ReportFindings::Row row{finding.what, finding.unit, {}, finding.meaning};
    for (const std::string& side : sides) {
      std::string value;
      for (const StepFolder* step : results.stepsOf(finding.command)) {
        if (side.empty() || step->side() == side || step->side().empty()) {
          value = valueIn(*step, finding);
        }
      }
      row.values.push_back(value);
    }
    const bool known =
        std::any_of(row.values.begin(), row.values.end(), [](const auto& v) { return !v.empty(); });
    if (known) findings.rows.push_back(std::move(row));
  }
  if (findings.rows.empty() && results.steps().size() == 1) {
    listOwnNumbers(results.steps().front(), findings);
  }
}

}  // namespace explica::pipeline
