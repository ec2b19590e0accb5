// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Surface/LevelSet.h"

#include <cstdint>

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

/// The zero within the cells whose eight corners are known: a surface with rims where these end.
/// Its edges have one or two faces; at a vertex of the rim several fans of faces may meet.
/// @param known  1 where the level is known; on the level's grid
[[nodiscard]] TriangleMesh extractIsoSurface(const LevelSet& level,
                                             const Volume<std::uint8_t>& known);

/// Share of a lattice edge that vertices keep from its ends.
inline constexpr double kLeastFraction = 0.02;

}  // namespace explica::surface
