// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <vector>

namespace explica::sampling {

/// Where a point lies in the cortex: the straight column from a white vertex to its pial vertex
/// that comes nearest to it.
struct ColumnPlace {
  std::int32_t vertex = -1;
  double depth = kNaN;     ///< share of the column's length from its white end, in [0, 1]
  double distance = kNaN;  ///< from the point to the column, mm
};

/// The nearest column of each point; of equally near ones that of the smaller vertex.
/// @param points  P x 3, RAS mm
/// @throws InvalidInput  surfaces that do not correspond, a point that is not finite
[[nodiscard]] std::vector<ColumnPlace> nearestColumns(const TriangleMesh& white,
                                                      const TriangleMesh& pial,
                                                      const Positions& points);

}  // namespace explica::sampling
