// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "RegionTables.h"

#include "Explica/Core/Text.h"

#include <algorithm>
#include <set>

namespace explica::study {
namespace {

/// A column of the table of `explica surface`, as the long table calls it.
struct SurfaceColumn {
  const char *heading, *measure, *unit;
};
constexpr SurfaceColumn kSurfaceColumns[] = {
    {"vertices", "vertices", "1"},
    {"area_white_mm2", "area", "mm^2"},
    {"volume_mm3", "volume", "mm^3"},
    {"thickness_mean_mm", "thickness_mean", "mm"},
    {"thickness_sd_mm", "thickness_sd", "mm"},
    {"thickness_nearest_mean_mm", "thickness_nearest_mean", "mm"},
    {"doubtful_share", "doubtful_share", "1"}};

/// A measure that has a column of the wide table, and how the column's name ends.
struct WideMeasure {
  const char *measure, *ending;
};
constexpr WideMeasure kWideMeasures[] = {{"thickness_mean", ""},
                                         {"thickness_sd", ".sd"},
                                         {"thickness_sd_vertices", ".sd"},
                                         {"area", ".area"},
                                         {"volume", ".volume"}};

}  // namespace

void addRegions(StudyRow& row, const std::string& fromSurface, const std::string& fromTemplate) {
  for (auto& cells : tableRows(fromSurface)) {
    for (const SurfaceColumn& column : kSurfaceColumns) {
      if (!cells.contains(column.heading)) continue;
      row.regions.push_back(
          {"surface", cells["name"], column.measure, cells[column.heading], column.unit});
    }
  }
  for (auto& cells : tableRows(fromTemplate)) {
    row.regions.push_back({"template " + cells["atlas"], cells["region"], cells["measure"],
                           cells["value"], cells["unit"]});
  }
  for (const RegionNumber& number : row.regions) {
    if (number.atlas != row.regions.front().atlas) break;
    for (const WideMeasure& wide : kWideMeasures) {
      if (number.measure != wide.measure) continue;
      row.values[std::string(kRegionPrefix) + number.region + wide.ending] = number.value;
    }
  }
}

bool isRegion(const std::string& column) {
  return column.starts_with(kRegionPrefix);
}

bool isRegionMean(const std::string& column) {
  return isRegion(column) && std::ranges::none_of(kWideMeasures, [&](const auto& wide) {
           return *wide.ending != '\0' && column.ends_with(wide.ending);
         });
}

std::string regionsText(const std::vector<StudyRow>& rows) {
  const std::vector<std::string> about = aboutColumns(rows);
  std::string text = "participant_id\themisphere\tatlas\tregion\tmeasure\tvalue\tunit\tstate";
  for (const std::string& column : about) text += "\t" + column;
  text += "\n";
  std::set<std::string> done;  // of several patches of a hemisphere the regions are the same
  for (const StudyRow& row : rows) {
    if (row.regions.empty() || !done.insert(row.participant + row.hemisphere).second) continue;
    std::string end = "\t" + row.state.substr(0, row.state.find(':'));
    for (const std::string& column : about) end += "\t" + valueIn(row, column);
    for (const RegionNumber& number : row.regions) {
      text += row.participant + "\t" + row.hemisphere + "\t" + number.atlas + "\t" + number.region +
              "\t" + number.measure + "\t" + number.value + "\t" + number.unit + end + "\n";
    }
  }
  return text;
}

}  // namespace explica::study
