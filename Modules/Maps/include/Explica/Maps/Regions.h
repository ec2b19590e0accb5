// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <span>
#include <vector>

namespace explica::maps {

/// Volume between two surfaces with the same faces at each vertex, V, mm^3: a third of the prisms
/// over its faces, each cut into three tetrahedra, as FreeSurfer's grey volume is.  Neighbouring
/// prisms are cut along the same diagonals, so that between closed surfaces the sum is the
/// difference of their enclosed volumes.
/// @throws InvalidInput  surfaces with different faces
[[nodiscard]] Eigen::VectorXd vertexVolumes(const TriangleMesh& white, const TriangleMesh& pial);

/// The values of a map in a region.
struct RegionMoments {
  Eigen::Index count = 0;      ///< vertices where the map is finite
  double sum = 0;              ///< over vertices
  double mean = kNaN;          ///< over vertices, each counted once, as FreeSurfer does
  double deviation = kNaN;     ///< of the vertices from it, with n
  double meanOverArea = kNaN;  ///< weighted by area
  double deviationOverArea = kNaN;
};

/// Moments of a map in regions; NaN is left out.
/// @param keys     V
/// @param areas    V, mm^2
/// @param regions  keys, whose order the result has
[[nodiscard]] std::vector<RegionMoments> regionMoments(std::span<const Label> keys,
                                                       const Eigen::VectorXd& values,
                                                       const Eigen::VectorXd& areas,
                                                       std::span<const Label> regions);

}  // namespace explica::maps
