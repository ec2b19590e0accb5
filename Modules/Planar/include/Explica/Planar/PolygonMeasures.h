// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/Curve.h"

namespace explica::planar {

/// How much of a viewing circle about `centre` is hidden from the points of a closed polygon,
/// [Thesis, Eq. 4.6], mm^2.
///
/// The integrand of (4.6) is the rate at which the ray from x to y moves along the circle, so the
/// inner integral telescopes to the arc behind x's tangent, whatever the rest of the curve does:
///
///     E = r sum_i |C_i| (2 pi - 2 acos(h_i / r)),
///
/// h_i the distance of edge i's line from the centre, outward positive.  Exact.  That is why its
/// flow smooths and does not unfold: for r to infinity E tends to pi r times the length.
/// @throws InvalidInput  a vertex on or outside the circle, an open curve
[[nodiscard]] double hiddenViewingArc(const Curve& curve, const Point2& centre, double radius);

/// Length by which a closed polygon hides itself, [Thesis, Eq. 4.7], mm^2: the measure of the pairs
/// (x, y) where y lies on the outer side of x's edge and shows x its outer side.  0 for convex
/// polygons.  Exact: for two edges the two conditions separate.  Pairs of runs of edges that are
/// all alike are taken at once: O(V log V) for smooth curves, O(V^2) at worst.
/// @throws InvalidInput  an open curve
[[nodiscard]] double selfOcclusion(const Curve& curve);

/// A global measure and how it changes with the vertices.
struct MeasureValue {
  double value = 0;     ///< mm^2
  Positions2 gradient;  ///< V x 2, mm, exact; of (4.7) one-sided where an edge's end lies on
                        ///< another's line
};
[[nodiscard]] MeasureValue hiddenViewingArcGradient(const Curve& curve, const Point2& centre,
                                                    double radius);
[[nodiscard]] MeasureValue selfOcclusionGradient(const Curve& curve);

}  // namespace explica::planar
