// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/IO/PointTableFile.h"
#include "Explica/Sampling/NearestColumn.h"
#include "Explica/Sampling/Statistics.h"

#include <string>
#include <vector>

namespace explica::app {

/// The table with the columns vertex, depth, distance and region added.
[[nodiscard]] std::string textOf(const io::PointTable& table,
                                 const std::vector<sampling::ColumnPlace>& places,
                                 const sampling::Regions& regions);

}  // namespace explica::app
