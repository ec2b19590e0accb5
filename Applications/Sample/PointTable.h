// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"
#include "Explica/Sampling/NearestColumn.h"
#include "Explica/Sampling/Statistics.h"

#include <filesystem>
#include <string>
#include <vector>

namespace explica::app {

/// Rows of a tab-separated file with the columns x, y and z: electrodes, coordinates of a paper.
struct PointTable {
  std::string heading;            ///< the file's, without line feed
  std::vector<std::string> rows;  ///< as they stand
  Positions places;               ///< RAS mm
};

/// @throws IOError       absent, unreadable
/// @throws InvalidInput  a column that is missing, a row without three numbers: names the line
[[nodiscard]] PointTable readPointTable(const std::filesystem::path& path);

/// The table with the columns vertex, depth, distance and region added.
[[nodiscard]] std::string textOf(const PointTable& table,
                                 const std::vector<sampling::ColumnPlace>& places,
                                 const sampling::Regions& regions);

/// "%.6g", and "n/a" for what is not known, as BIDS has it.
[[nodiscard]] std::string cell(double value);

}  // namespace explica::app
