// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <filesystem>
#include <string>
#include <vector>

namespace explica::io {

/// Rows of a tab-separated file with the columns x, y and z: electrodes, coordinates of a paper.
struct PointTable {
  std::string heading;            ///< the file's, without line feed
  std::vector<std::string> rows;  ///< as they stand
  Positions places;               ///< RAS mm
};

/// @throws IOError       absent, unreadable
/// @throws InvalidInput  a column that is missing, a row without three numbers, a point farther
/// than
///                       10 km from the origin: names the row
[[nodiscard]] PointTable readPointTable(const std::filesystem::path& path);

}  // namespace explica::io
