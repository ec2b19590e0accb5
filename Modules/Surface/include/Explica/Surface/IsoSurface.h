// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Surface/LevelSet.h"

namespace explica::surface {

/// The zero of a level set by marching the Freudenthal tetrahedra.
///
/// The result is a closed oriented manifold, outward where the level falls, whose topology is that
/// of the boundary between positive and negative lattice points in the sense of
/// correctTopology(), and it does not intersect itself: tetrahedra meet in common faces only, and
/// vertices keep `kLeastFraction` of an edge away from lattice points.
///
/// @param level  negative on the border of the box, nowhere 0
/// @throws InvalidInput  a positive voxel on the border
[[nodiscard]] TriangleMesh extractIsoSurface(const LevelSet& level);

/// Share of a lattice edge that vertices keep from its ends.
inline constexpr double kLeastFraction = 0.02;

}  // namespace explica::surface
