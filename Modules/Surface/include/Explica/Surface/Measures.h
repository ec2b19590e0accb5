// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Grid.h"
#include "Explica/Core/TriangleMesh.h"

#include <cstdint>

namespace explica::surface {

/// What tells an even surface from a crumpled one.
struct Evenness {
  double dihedralAbove60 = 0;  ///< share of the edges whose faces' normals are more than 60 degrees
                               ///< apart
  double longestEdge = 0;      ///< mm
  double leastFace = 0;        ///< area, mm^2
  double highestSpike = 0;     ///< farthest that a vertex is from the mean of its neighbours, mm
};

/// @param mesh  closed manifold
[[nodiscard]] Evenness evennessOf(const TriangleMesh& mesh);

/// Radius of the ball that has the volume of so many voxels, mm.
[[nodiscard]] double radiusOfVoxels(std::int64_t count, const Grid& grid);

}  // namespace explica::surface
