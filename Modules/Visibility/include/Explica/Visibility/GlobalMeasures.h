// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

namespace explica::visibility {

/// How much of a viewing sphere is hidden from a closed surface's points, in three dimensions what
/// [Thesis, Eq. 4.6] is in two: the area of the sphere covered by the surface as seen from x,
/// counted with sign, integrated over x.
///
///   E = integral over x, y of t^2 / (w . q / r) * (d . n(y)) / |d|^3,  d = y - x, w = d / |d|,
///
/// q = x + t w the point of the sphere of radius r about `centre` in the direction of y, n outward.
/// For a closed smooth surface of area A and volume V the inner integral is the cap of the sphere
/// behind x's tangent plane, hence E = 2 pi r^2 A + 6 pi r V: as the thesis says of its plane form,
/// its flow smooths and does not unfold.  Centroid rule: O(F^2) time, first order in the edge
/// length.
/// @return mm^4
/// @throws InvalidInput  a vertex on or outside the sphere
[[nodiscard]] double hiddenViewingArea(const TriangleMesh& mesh, const Point& centre,
                                       double radius);

/// Area by which the surface hides itself, [Thesis, Eq. 4.7]: the area of the pairs (x, y) where y
/// lies on the outer side of x's tangent plane and shows x its outer side.  0 for convex surfaces.
/// Centroid rule: O(F^2) time.
/// @return mm^4
[[nodiscard]] double selfOcclusion(const TriangleMesh& mesh);

}  // namespace explica::visibility
