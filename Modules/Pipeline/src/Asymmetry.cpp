// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Pipeline/Asymmetry.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/FileText.h"
#include "Explica/Core/Types.h"

#include <cmath>
#include <cstdlib>
#include <map>
#include <sstream>
#include <vector>

namespace explica::pipeline {
namespace {

struct Region {
  double thickness = kNaN;
  double area = kNaN;
};

std::string withoutSide(std::string name) {
  for (const std::string_view ending : {"_L", "_R"}) {
    if (name.ends_with(ending)) name.resize(name.size() - ending.size());
  }
  for (const std::string_view beginning : {"ctx-lh-", "ctx-rh-", "lh_", "rh_"}) {
    if (name.starts_with(beginning)) name.erase(0, beginning.size());
  }
  return name;
}

double numberIn(const std::string& cell) {
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  return end != cell.c_str() && *end == '\0' ? value : kNaN;
}

std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream text(line);
  for (std::string cell; std::getline(text, cell, '\t');) cells.push_back(cell);
  return cells;
}

std::map<std::string, Region> readRegions(const std::filesystem::path& path) {
  std::istringstream file(fileText(path));
  std::string line;
  if (!std::getline(file, line)) throw IOError(path.string() + ": cannot be read");
  const std::vector<std::string> heads = cellsOf(line);
  const auto column = [&](const char* name) {
    for (std::size_t c = 0; c < heads.size(); ++c) {
      if (heads[c] == name) return c;
    }
    throw IOError(path.string() + ": has no column " + name);
  };
  const std::size_t name = column("name");
  const std::size_t thickness = column("thickness_mean_mm");
  const std::size_t area = column("area_white_mm2");
  std::map<std::string, Region> regions;
  while (std::getline(file, line)) {
    const std::vector<std::string> cells = cellsOf(line);
    if (cells.size() < heads.size()) continue;
    regions[withoutSide(cells[name])] = {numberIn(cells[thickness]), numberIn(cells[area])};
  }
  return regions;
}

void addPair(std::ostream& table, double left, double right) {
  for (const double value : {left, right, (left - right) / (0.5 * (left + right))}) {
    if (std::isfinite(value)) {
      table << '\t' << value;
    } else {
      table << "\tn/a";
    }
  }
}

}  // namespace

std::string asymmetryTable(const std::filesystem::path& left, const std::filesystem::path& right) {
  const auto ofLeft = readRegions(left);
  const auto ofRight = readRegions(right);
  std::ostringstream table;
  table << "name\tthickness_left_mm\tthickness_right_mm\tthickness_asymmetry\t"
           "area_left_mm2\tarea_right_mm2\tarea_asymmetry\n";
  for (const auto& [name, region] : ofLeft) {
    const auto other = ofRight.find(name);
    if (other == ofRight.end()) continue;
    table << name;
    addPair(table, region.thickness, other->second.thickness);
    addPair(table, region.area, other->second.area);
    table << '\n';
  }
  return table.str();
}

}  // namespace explica::pipeline
