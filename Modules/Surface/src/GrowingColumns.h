// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/FaceTree.h"
#include "Explica/Surface/CorticalTissue.h"
#include "Explica/Surface/LevelSet.h"
#include "RibbonPaths.h"

#include <cstdint>
#include <vector>

namespace explica::surface {

/// Columns of tissue upon a white surface.
struct GrowingColumns {
  CorticalTissue tissue;  ///< corrected
  std::vector<Trajectory> paths;
};

/// The tissue with its white matter's topology corrected.
/// @param white  level of that white matter
[[nodiscard]] CorticalTissue corrected(CorticalTissue tissue, const LevelSet& white);

/// Trajectories from the vertices of `white` that have tissue upon them.
void takePaths(const TriangleMesh& white, const RibbonPaths& ribbon, GrowingColumns& columns);

/// Where a path no longer leaves white matter behind: from there surfaces that grew along it would
/// crowd on the floor of a sulcus, or pass into the other bank's columns.
/// @param face   of the white surface near the path's start
/// @param voxel  mm
/// @param first  least arc length, mm
/// @return arc length; the path's own if it leaves white matter behind everywhere
[[nodiscard]] double stallOf(const geometry::FaceTree& white, std::int32_t face, double voxel,
                             double first, const Trajectory& path);

}  // namespace explica::surface
