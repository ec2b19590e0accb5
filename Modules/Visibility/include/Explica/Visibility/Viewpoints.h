// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <vector>

namespace explica::visibility {

/// From where a surface is looked at: points with weights that sum to 1.
///
/// One point is the thesis's viewpoint; a line or a surface of viewpoints (thesis chapter 6) is its
/// quadrature, so that every measure of a viewpoint carries over as a weighted mean.
struct Viewpoints {
  std::vector<Point> points;    ///< RAS, mm
  std::vector<double> weights;  ///< > 0, sum 1
};

[[nodiscard]] Viewpoints viewpoint(const Point& point);

/// Several points at once; weights are divided by their sum, and are equal if none are given.
/// @throws InvalidInput  no point, one that is not finite, another number of weights than of
///                       points, or a weight that is not positive
[[nodiscard]] Viewpoints viewpoints(const std::vector<Point>& points,
                                    const std::vector<double>& weights = {});

/// Segment from `start` to `end`, Gauss-Legendre: exact for integrands of degree 2 * count - 1.
/// @throws InvalidInput  count outside [1, 64], or a non-finite end
[[nodiscard]] Viewpoints viewLine(const Point& start, const Point& end, int count = 8);

/// Surface of viewpoints, by area: the three-point rule of degree 2 on each face.
/// @throws InvalidInput  no face, or no area
[[nodiscard]] Viewpoints viewSurface(const TriangleMesh& surface);

/// Times that a closed surface winds around a point: 1 inside, 0 outside, 1/2 on a smooth part of
/// it. Sum of the faces' solid angles over 4 pi.
[[nodiscard]] double windingNumber(const TriangleMesh& surface, const Point& point);

}  // namespace explica::visibility
