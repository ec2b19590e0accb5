// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/SelfIntersection.h"

#include <span>

namespace explica::collision {

/// Length of all segments in which pairs of faces cross, and its gradient [Volino2006].
struct CrossingLength {
  double value = 0;    ///< mm
  Positions gradient;  ///< V x 3, no unit
};

/// The gradient is exact unless an edge grazes the face that it pierces (sine below 0.1): its rate
/// is bounded there.  Pairs without a segment count as zero.
[[nodiscard]] CrossingLength crossingLength(const TriangleMesh& mesh,
                                            std::span<const geometry::FacePair> pairs);

}  // namespace explica::collision
