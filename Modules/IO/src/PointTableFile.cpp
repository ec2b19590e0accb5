// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/PointTableFile.h"

#include "ByteSource.h"

#include "Explica/Core/Text.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace explica::io {
namespace {

double coordinateOf(const std::filesystem::path& path, std::string_view word, std::size_t row) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  const std::string where =
      "row " + std::to_string(row) + " has '" + std::string(word.substr(0, 40));
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) {
    refuse(path, where + "' where a coordinate is needed");
  }
  if (std::abs(value) > kFarthest) {
    refuse(path, where + "', farther than 10 km from the origin; coordinates are in mm");
  }
  return value;
}

}  // namespace

PointTable readPointTable(const std::filesystem::path& path) {
  const Bytes bytes = ByteSource(path).rest(ByteSource::kMostText);
  ByteCursor cursor(path, bytes, false);
  PointTable table;
  while (cursor.left() > 0) {
    const std::string_view line = cursor.line();
    if (!line.empty()) table.rows.emplace_back(line);
  }
  if (table.rows.empty()) refuse(path, "is empty");
  table.heading = table.rows.front();
  table.rows.erase(table.rows.begin());
  if (table.rows.empty()) refuse(path, "holds no point");
  const std::vector<std::string> names = cellsOf(table.heading);
  std::array<std::size_t, 3> column{};
  for (int axis = 0; axis < 3; ++axis) {
    const std::string wanted(1, "xyz"[axis]);
    column[axis] = std::ranges::find(names, wanted) - names.begin();
    if (column[axis] == names.size()) {
      refuse(path, "its first line names no column '" + wanted +
                       "'; x, y and z (RAS, mm), separated by tabs, are needed");
    }
  }
  table.places.resize(static_cast<Eigen::Index>(table.rows.size()), 3);
  for (std::size_t n = 0; n < table.rows.size(); ++n) {
    const std::vector<std::string> cells = cellsOf(table.rows[n]);
    for (int axis = 0; axis < 3; ++axis) {
      if (cells.size() <= column[axis]) {
        refuse(path, "row " + std::to_string(n + 1) + " is too short");
      }
      table.places(static_cast<Eigen::Index>(n), axis) =
          coordinateOf(path, cells[column[axis]], n + 1);
    }
  }
  return table;
}

}  // namespace explica::io
