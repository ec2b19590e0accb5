// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Pipeline/Asymmetry.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/FileText.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/Types.h"
#include "Explica/IO/StatedHemisphere.h"

#include <map>
#include <vector>

namespace explica::pipeline {
namespace {

constexpr const char* kThickness = "thickness_mean_mm";
constexpr const char* kArea = "area_white_mm2";

struct Region {
  double thickness = kNaN;
  double area = kNaN;
};

std::map<std::string, Region> readRegions(const std::filesystem::path& path) {
  const std::string table = fileText(path);
  const std::vector<std::string> headings = cellsOf(table.substr(0, table.find('\n')));
  for (const char* heading : {"name", kThickness, kArea}) {
    if (std::ranges::find(headings, heading) == headings.end()) {
      throw IOError(path.string() + ": has no column " + heading);
    }
  }
  std::map<std::string, Region> regions;
  for (const TableRow& row : tableRows(table)) {
    regions[io::withoutSide(row.at("name"))] = {numberIn(row, kThickness), numberIn(row, kArea)};
  }
  return regions;
}

std::string pairText(double left, double right) {
  return "\t" + cellText(left) + "\t" + cellText(right) + "\t" +
         cellText((left - right) / (0.5 * (left + right)));
}

}  // namespace

std::string asymmetryTable(const std::filesystem::path& left, const std::filesystem::path& right) {
  const auto ofLeft = readRegions(left);
  const auto ofRight = readRegions(right);
  std::string table =
      "name\tthickness_left_mm\tthickness_right_mm\tthickness_asymmetry\tarea_left_mm2\tarea_right_"
      "mm2\tarea_asymmetry\n";
  for (const auto& [name, region] : ofLeft) {
    const auto other = ofRight.find(name);
    if (other == ofRight.end()) continue;
    table += name + pairText(region.thickness, other->second.thickness) +
             pairText(region.area, other->second.area) + "\n";
  }
  return table;
}

}  // namespace explica::pipeline
