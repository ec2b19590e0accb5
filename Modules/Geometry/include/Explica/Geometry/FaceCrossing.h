// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/SelfIntersection.h"

#include <array>
#include <optional>

namespace explica::geometry {

/// An end of the segment in which two faces cross: where an edge of one pierces the other.
struct CrossingEnd {
  Point point = Point::Constant(kNaN);
  std::array<std::int32_t, 2> edge = {-1, -1};      ///< its two ends; equal at a common vertex
  std::array<double, 2> edgeWeights = {1, 0};       ///< point = sum of weights times ends
  std::array<std::int32_t, 3> face = {-1, -1, -1};  ///< the pierced one; -1 at a common vertex
  std::array<double, 3> faceWeights = {0, 0, 0};    ///< barycentric coordinates of the point
};

using CrossingSegment = std::array<CrossingEnd, 2>;

/// The segment in which two intersecting faces cross, in floating point; nothing for faces that
/// only touch, lie in one plane, or whose crossing is lost in rounding.
[[nodiscard]] std::optional<CrossingSegment> crossingSegment(const TriangleMesh& mesh,
                                                             const FacePair& pair);

/// Where two intersecting faces meet: the middle of their segment, else of their centroids.
[[nodiscard]] Point placeOfCrossing(const TriangleMesh& mesh, const FacePair& pair);

}  // namespace explica::geometry
