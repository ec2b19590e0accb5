// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Core/Volume.h"

#include <cstdint>

namespace explica::geometry {

/// The zero of a field that is positive inside, by marching the six Freudenthal tetrahedra of each
/// cell of its grid.
///
/// The result is a closed oriented manifold, outward where the level falls, whose topology is that
/// of the boundary between positive and negative lattice points, each of which has its 14
/// neighbours in that triangulation, and it does not intersect itself: tetrahedra meet in common
/// faces only, and vertices keep `kLeastFraction` of an edge away from lattice points.
///
/// @param level  negative on the border of the box
/// @throws InvalidInput  a positive voxel on the border
[[nodiscard]] TriangleMesh extractIsoSurface(const Volume<float>& level);

/// The zero within the cells whose eight corners are known: a surface with rims where these end.
/// Its edges have one or two faces; at a vertex of the rim several fans of faces may meet.
/// @param known  1 where the level is known; on the level's grid
[[nodiscard]] TriangleMesh extractIsoSurface(const Volume<float>& level,
                                             const Volume<std::uint8_t>& known);

/// Share of a lattice edge that vertices keep from its ends.
inline constexpr double kLeastFraction = 0.02;

}  // namespace explica::geometry
