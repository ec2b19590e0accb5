// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "PointTable.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace explica::app {
namespace {

std::vector<std::string> cellsOf(const std::string& line) {
  std::vector<std::string> cells;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = line.find('\t', begin);
    cells.push_back(line.substr(begin, end - begin));
    if (end == std::string::npos) return cells;
    begin = end + 1;
  }
}

double number(const std::string& word, const std::string& where) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) {
    throw InvalidInput(where + " has '" + word.substr(0, 40) + "' where a coordinate is needed");
  }
  return value;
}

}  // namespace

PointTable readPointTable(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw IOError(path.string() + ": cannot be read");
  PointTable table;
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (!line.empty()) lines.push_back(line);
  }
  if (lines.empty()) throw InvalidInput(path.string() + ": is empty");
  table.heading = lines.front();
  const std::vector<std::string> names = cellsOf(table.heading);
  std::array<std::size_t, 3> column{};
  for (int axis = 0; axis < 3; ++axis) {
    const std::string wanted(1, "xyz"[axis]);
    column[axis] = std::find(names.begin(), names.end(), wanted) - names.begin();
    if (column[axis] == names.size()) {
      throw InvalidInput(path.string() + ": its first line names no column '" + wanted +
                         "'; x, y and z (RAS, mm), separated by tabs, are needed");
    }
  }
  table.places.resize(static_cast<Eigen::Index>(lines.size() - 1), 3);
  for (std::size_t n = 1; n < lines.size(); ++n) {
    const std::vector<std::string> cells = cellsOf(lines[n]);
    const std::string where = path.string() + ": row " + std::to_string(n);
    for (int axis = 0; axis < 3; ++axis) {
      if (cells.size() <= column[axis]) throw InvalidInput(where + " is too short");
      table.places(static_cast<Eigen::Index>(n - 1), axis) = number(cells[column[axis]], where);
    }
    table.rows.push_back(lines[n]);
  }
  if (table.rows.empty()) throw InvalidInput(path.string() + ": holds no point");
  return table;
}

std::string cell(double value) {
  if (!std::isfinite(value)) return "n/a";
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string textOf(const PointTable& table, const std::vector<sampling::ColumnPlace>& places,
                   const sampling::Regions& regions) {
  std::string text = table.heading + "\tvertex\tdepth\tdistance\tregion\n";
  for (std::size_t n = 0; n < places.size(); ++n) {
    const sampling::ColumnPlace& place = places[n];
    const std::string& region = regions.nameAt(static_cast<std::size_t>(place.vertex));
    text += table.rows[n] + "\t" + std::to_string(place.vertex) + "\t" + cell(place.depth) + "\t" +
            cell(place.distance) + "\t" + (region.empty() ? "n/a" : region) + "\n";
  }
  return text;
}

}  // namespace explica::app
