// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "RibbonPaths.h"

#include <cstdint>
#include <vector>

namespace explica::surface {

/// Cuts what surfaces shall not follow: a trajectory 1.3 times as long as the median of the
/// vertices within two edges, and longer by half a voxel, has gone astray, along the floor of a
/// sulcus or into the next one, and a vertex at its end would stand against other banks.  It ends
/// at that median.
/// @param voxel  the least spacing, mm
/// @param paths  per vertex of the white surface; those without ribbon have no say
/// @return how many were cut
std::int64_t shortenAstray(const TriangleMesh& white, double voxel, std::vector<Trajectory>& paths);

}  // namespace explica::surface
