// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Study/StudyTable.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/FileText.h"
#include "Explica/Core/Folders.h"
#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Text.h"
#include "Explica/Provenance/Doubts.h"
#include "Explica/Provenance/Json.h"
#include "RegionTables.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <sstream>

namespace explica::study {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

// In the order of those that come first; others follow by name.
constexpr KnownColumn kColumns[] = {
    {"surface.thickness_mean", "Cortical thickness, mean", "mm", true, true},
    {"thickness.thickness_mean", "Thickness of the volume, mean", "mm", true, true},
    {"thickness.sulcal_voxels_recovered", "Sulcal voxels recovered", "", true, false},
    {"surface.faces", "Faces of a surface", "", true, false},
    {"surface.euler_characteristic", "Euler characteristic", "", true, false},
    {"surface.defects_corrected", "Defects corrected", "", true, true},
    {"surface.voxels_changed", "Voxels changed", "", true, true},
    {"surface.self_intersections", "Surface crossings", "", true, false},
    {"surface.area_white", "White area", "mm\u00b2", true, true},
    {"surface.area_pial", "Pial area", "mm\u00b2", true, true},
    {"unfold.region_area", "Patch area", "mm\u00b2", true, false},
    {"unfold.visibility_initial", "Visibility before", "", true, false},
    {"unfold.visibility_final", "Visibility after", "", true, true},
    {"unfold.seen_initial", "Seen before", "", true, false},
    {"unfold.seen_final", "Seen after", "", true, true},
    {"unfold.area_error_mean", "Area error, mean", "", true, true},
    {"unfold.edge_strain_mean", "Edge strain, mean", "", true, true},
    {"unfold.self_intersections_final", "Patch crossings", "", true, false},
    {"unfold.iterations", "Iterations of the unfolding", "", true, false},
    {"unfold.stop_reason", "Why the unfolding stopped", "", true, false},
    {"rating.wrong", "Places rated wrong", "", true, false},
    {"rating.unsure", "Places rated unsure", "", true, false},
    {"rating.right", "Places rated right", "", true, false},
    {"thickness.thickness_median", "Thickness, median of voxels", "mm", false, false},
    {"surface.volume_white", "Volume inside the white surface", "mm\u00b3", false, true},
    {"thickness.traced_fraction", "Trajectories followed, share", "", false, true},
    {"register.folding_correlation_after", "Correlation of sulcal depth", "", false, true},
    {"group.distance_thickness", "Thickness, distance from the group", "z", false, true},
    {"group.distance_sulc", "Sulcal depth, distance from the group", "z", false, true},
    {"group.distance_area", "Area, distance from the group", "z", false, true},
};

/// Steps whose numbers make a row.
constexpr const char* kSteps[] = {"segment", "thickness", "surface", "register", "unfold"};

std::string textOf(const Json& value) {
  if (value.is_null()) return "n/a";
  return cellText(value.is_string() ? value.get<std::string>() : provenance::textOf(value));
}

/// Numbers and words of a step's summary; lists and objects do not fit a table, times do not
/// belong.
void addSummary(StudyRow& row, const std::string& step, const Json& summary) {
  static const std::set<std::string> left = {"command", "peak_memory_bytes", "warnings"};
  for (const auto& [key, value] : summary.items()) {
    if (value.is_structured() || left.count(key) || key.starts_with("seconds")) continue;
    row.values[step + "." + key] = textOf(value);
  }
}

void addState(StudyRow& row, const Json& account) {
  row.state = "failed: it did not begin";
  if (account.is_null()) return;
  row.state = "done";
  for (const Json& step : account["steps"]) {
    std::string state = textOf(step["state"]);
    if (state == "done") continue;
    if (state == "stopped") state = "stopped early";
    if (state != "failed" && row.state != "done") continue;  // the first explains the rest
    const std::string message = step.contains("message") ? textOf(step["message"]) : "";
    row.state = state + " (" + textOf(step["name"]) + ")" + (message.empty() ? "" : ": " + message);
    if (state == "failed") return;
  }
}

/// A step whose numbers cannot be believed fails the row; what failed before explains more.
void addFlags(StudyRow& row, const std::string& step, const Json& summary) {
  if (row.state != "done") return;
  for (const Json& flag : summary.value("flags", Json::array())) {
    if (summary.value("plausible", true) || flag.value("accepted", false)) continue;
    row.state = "implausible (" + step + "): " + textOf(flag.value("message", Json("")));
    return;
  }
  const Json reasons = summary.value("reasons", Json::array());
  if (summary.value("verdict", "") != "doubtful" || reasons.empty()) return;
  row.state = "implausible (" + step + "): " + textOf(reasons.front());
}

/// What somebody has judged of a run's places, as its page saves it: beside the page or in
/// `out/ratings`.  A place that is wrong fails the row.
void addRating(StudyRow& row, const fs::path& out, const fs::path& run) {
  const std::string name = run.filename().string() + "_rating.json";
  for (const fs::path& file : {run / name, out / "ratings" / name}) {
    if (!isThere(file)) continue;
    const Json rating = provenance::readJson(file);
    if (rating.value("format", "") != "explica-rating" || !rating.contains("ratings")) {
      throw InvalidInput(file.string() + ": is not a rating that the page of a run has saved");
    }
    std::map<std::string, int> counts = {{"wrong", 0}, {"unsure", 0}, {"right", 0}};
    for (const Json& place : rating["ratings"]) ++counts[textOf(place["rating"])];
    for (const char* word : {"wrong", "unsure", "right"}) {
      row.values[std::string("rating.") + word] = std::to_string(counts[word]);
    }
    if (counts["wrong"] == 0 || row.state != "done") continue;
    row.state = "implausible (rating): places rated wrong: " + row.values["rating.wrong"];
  }
}

StudyRow rowOf(const fs::path& out, const fs::path& run) {
  StudyRow row;
  const std::string name = run.filename().string();
  const std::size_t hemi = name.rfind("_hemi-");
  row.participant = name.substr(0, hemi);
  row.hemisphere = name.substr(hemi + 6);
  constexpr std::string_view kRegion = "_region-";  // stands before a region's name in a folder's
  if (const auto at = row.hemisphere.find(kRegion); at != std::string::npos) {
    row.region = row.hemisphere.substr(at + kRegion.size());
    row.hemisphere.resize(at);
  }
  try {
    const Json account = accountOf(run);
    addState(row, account["run"]);
    for (const char* step : kSteps) {
      if (!account["steps"].contains(step)) continue;
      addSummary(row, step, account["steps"][step]);
      addFlags(row, step, account["steps"][step]);
    }
    addRegions(row, account.value("surface_regions", std::string()),
               account.value("regions", std::string()));
    addRating(row, out, run);
  } catch (const std::exception& fault) {  // a damaged file is a fact of the study, not its end
    row.state = std::string("failed: ") + fault.what();
  }
  if (const std::string problem = problemIn(run); !problem.empty()) row.state = problem;
  if (isThere(run / "report.html")) row.report = fs::relative(run / "report.html", out);
  if (isThere(run / "thumbnail.png")) row.thumbnail = fs::relative(run / "thumbnail.png", out);
  return row;
}

std::optional<double> numberIn(const StudyRow& row, const std::string& column) {
  const auto value = row.values.find(column);
  if (value == row.values.end()) return std::nullopt;
  char* end = nullptr;
  const double number = std::strtod(value->second.c_str(), &end);
  const bool whole = end != value->second.c_str() && *end == '\0' && std::isfinite(number);
  return whole ? std::optional(number) : std::nullopt;
}

double medianOf(std::vector<double> values) {
  const std::size_t half = values.size() / 2;
  const double upper = nthSmallest(values, half);
  if (values.size() % 2 == 1) return upper;
  return 0.5 * (upper + nthSmallest(values, half - 1));
}

/// What of a row's inputs was cut, guessed or contradicted.
void flagDoubts(const StudyRow& row, std::vector<StudyFlag>& flags) {
  for (const char* step : kSteps) {
    for (const provenance::Doubt& doubt : provenance::kDoubts) {
      const std::string column = std::string(step) + "." + doubt.key;
      if (numberIn(row, column).value_or(0) > 0) flags.push_back({column, doubt.meaning});
    }
  }
}

/// Marks the rows whose number is far from the others'.
void flagOutliers(const std::vector<StudyRow>& rows, const std::vector<std::size_t>& group,
                  const std::string& column, std::vector<std::vector<StudyFlag>>& flags) {
  std::vector<double> values;
  for (const std::size_t n : group) {
    if (const auto number = numberIn(rows[n], column)) values.push_back(*number);
  }
  if (values.size() < 8) return;
  const double median = medianOf(values);
  for (double& value : values) value = std::abs(value - median);
  const double spread = medianOf(std::move(values));
  if (!(spread > 0)) return;
  for (const std::size_t n : group) {
    const auto number = numberIn(rows[n], column);
    if (!number) continue;
    const double z = 0.6745 * (*number - median) / spread;
    if (std::abs(z) <= 3.5) continue;  // [IglewiczHoaglin1993]
    flags[n].push_back({column, printed("robust z %.1f", z)});
  }
}

}  // namespace

std::string cellText(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return c == '\t' || c == '\n' || c == '\r'; }, ' ');
  return text;
}

std::string valueIn(const StudyRow& row, const std::string& column) {
  const auto value = row.values.find(column);
  return value == row.values.end() ? "n/a" : value->second;
}

std::string problemIn(const fs::path& run) {
  if (!isThere(run / "problem.txt")) return "";
  std::istringstream file(fileText(run / "problem.txt"));
  std::string problem;
  std::getline(file, problem);
  return problem == "interrupted" ? problem : "failed: " + problem;
}

Json accountOf(const fs::path& run) {
  if (isThere(run / kKeptName)) return provenance::readJson(run / kKeptName);
  const auto read = [](const fs::path& file) {
    return isThere(file) ? provenance::readJson(file) : Json();
  };
  Json all = {{"run", read(run / "run.json")}, {"steps", Json::object()}};
  for (const char* step : kSteps) {
    Json summary = read(run / step / "summary.json");
    if (!summary.is_null()) all["steps"][step] = std::move(summary);
  }
  for (const auto& [name, step] :
       {std::pair{"surface_regions", "surface"}, {"regions", "regions"}}) {
    const fs::path regions = run / step / "regions.tsv";
    if (isThere(regions)) all[name] = fileText(regions);
  }
  return all;
}

std::vector<StudyRow> collectRows(const fs::path& out, const std::string& subject) {
  const fs::path runs = out / "runs";
  if (!isFolder(runs)) {
    throw InvalidInput(out.string() + ": holds no runs; do the participant level first");
  }
  const auto isRun = [&](const std::string& name) {
    return name.starts_with("sub-") && (subject.empty() || name.starts_with(subject + "_")) &&
           name.find("_hemi-") != std::string::npos;
  };
  std::vector<StudyRow> rows;
  for (const fs::path& run : foldersOf(runs, isRun)) {
    checkpoint();
    rows.push_back(rowOf(out, run));
  }
  return rows;
}

const KnownColumn* knownColumn(const std::string& name) {
  const auto* known = std::ranges::find(kColumns, name, &KnownColumn::name);
  return known == std::end(kColumns) ? nullptr : known;
}

bool isCompared(const std::string& column) {
  const KnownColumn* known = knownColumn(column);
  return isRegionMean(column) || (known && known->compared);
}

bool isFirst(const std::string& column) {
  const KnownColumn* known = knownColumn(column);
  return known && known->first;
}

std::vector<std::string> aboutColumns(const std::vector<StudyRow>& rows) {
  std::set<std::string> about;
  for (const StudyRow& row : rows) {
    for (const auto& [column, value] : row.values) {
      if (column.starts_with(kAboutPrefix)) about.insert(column);
    }
  }
  return {about.begin(), about.end()};
}

std::vector<std::string> columnsOf(const std::vector<StudyRow>& rows) {
  std::set<std::string> all;
  for (const StudyRow& row : rows) {
    for (const auto& [column, value] : row.values) all.insert(column);
  }
  std::vector<std::string> columns;
  for (const KnownColumn& known : kColumns) {
    if (known.first && all.erase(known.name)) columns.emplace_back(known.name);
  }
  columns.insert(columns.end(), all.begin(), all.end());
  std::stable_partition(columns.begin(), columns.end(),
                        [](const std::string& column) { return !isRegion(column); });
  return columns;
}

std::vector<std::vector<StudyFlag>> flagsOf(const std::vector<StudyRow>& rows) {
  std::vector<std::vector<StudyFlag>> flags(rows.size());
  std::map<std::string, std::vector<std::size_t>> groups;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const StudyRow& row = rows[n];
    groups[row.region].push_back(n);
    if (row.state != "done")
      flags[n].push_back({"state", row.state.substr(0, row.state.find(':'))});
    const auto number = [&](const char* column) { return numberIn(row, column); };
    if (number("surface.euler_characteristic").value_or(2) != 2) {
      flags[n].push_back({"surface.euler_characteristic", "the white surface is no sphere"});
    }
    if (number("surface.self_intersections").value_or(0) > 0) {
      flags[n].push_back({"surface.self_intersections", "the surfaces meet themselves"});
    }
    if (number("unfold.self_intersections_final").value_or(0) >
        number("unfold.self_intersections_initial").value_or(0)) {
      flags[n].push_back({"unfold.self_intersections_final", "the patch meets itself"});
    }
    flagDoubts(row, flags[n]);
  }
  for (const auto& [region, group] : groups) {
    for (const std::string& column : columnsOf(rows)) {
      if (isCompared(column)) flagOutliers(rows, group, column, flags);
    }
  }
  return flags;
}

namespace {

/// The rows with some of their columns.
std::string textOf(const std::vector<StudyRow>& rows, const std::vector<std::string>& columns,
                   bool withFlags) {
  const auto flags = flagsOf(rows);
  const bool regions =
      std::ranges::any_of(rows, [](const StudyRow& row) { return !row.region.empty(); });
  std::string text = "participant_id\themisphere";
  if (regions) text += "\tregion";
  text += withFlags ? "\tstate\tflags" : "\tstate";
  for (const auto& column : columns) text += "\t" + column;
  text += "\n";
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const StudyRow& row = rows[n];
    text += row.participant + "\t" + row.hemisphere;
    if (regions) text += "\t" + (row.region.empty() ? "n/a" : row.region);
    std::string marks;
    for (const StudyFlag& flag : flags[n]) {
      marks += (marks.empty() ? "" : "; ") + flag.column + ": " + flag.reason;
    }
    text += "\t" + row.state;
    if (withFlags) text += "\t" + (marks.empty() ? "n/a" : marks);
    for (const auto& column : columns) text += "\t" + valueIn(row, column);
    text += "\n";
  }
  return text;
}

/// Numbers that a study is about; the others tell how the steps went.
bool isInternal(const std::string& column) {
  return !isFirst(column) && !isCompared(column) && !isRegion(column) &&
         !column.starts_with(kAboutPrefix);
}

}  // namespace

std::string tableText(const std::vector<StudyRow>& rows) {
  std::vector<std::string> columns = columnsOf(rows);
  std::erase_if(columns, isInternal);
  return textOf(rows, columns, true);
}

std::string internalsText(const std::vector<StudyRow>& rows) {
  std::vector<std::string> columns = columnsOf(rows);
  std::erase_if(columns, [](const std::string& column) { return !isInternal(column); });
  return textOf(rows, columns, false);
}

}  // namespace explica::study
