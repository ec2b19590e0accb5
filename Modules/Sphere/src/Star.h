// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Flattening/Coarsening.h"
#include "Explica/Sphere/SphereEnergy.h"

#include <optional>
#include <vector>

namespace explica::sphere {

/// The neighbours of a vertex on the unit sphere, counter-clockwise.
using Ring = std::vector<Point>;

/// True if every face of `place` with two neighbours is positive; exact.
[[nodiscard]] bool seesRing(const Ring& ring, const Point& place);

/// A place that sees the whole ring: the middle of all such places, a convex spherical polygon, or
/// where rounding leaves none of that, one beside the first neighbour.
[[nodiscard]] std::optional<Point> placeInside(const Ring& ring);

/// Lowers the energy of the faces about one vertex by damped Newton steps.
/// @param rest   the faces, corner 0 the vertex, corner 1 neighbour n, corner 2 the next
/// @param place  sees the ring
[[nodiscard]] Point relaxedPlace(const std::vector<RestFace>& rest, const Ring& ring,
                                 const MapWeights& weights, const Point& place);

/// Puts a vertex back that flattening::coarsen() took out.
/// @param scale  of the lengths of the removal, so that the surface has the area of the unit sphere
/// @return false if rounding leaves no room
[[nodiscard]] bool insert(const flattening::Removal& removal, double scale,
                          const MapWeights& weights, Positions& sphere);

}  // namespace explica::sphere
