// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/Curve.h"

#include <algorithm>

namespace explica::planar {

/// Where on the segment (a, b), in [0, 1], lies the point nearest to q.
inline double nearestParameter(const Point2& q, const Point2& a, const Point2& b) {
  const Point2 t = b - a;
  return std::clamp((q - a).dot(t) / t.squaredNorm(), 0.0, 1.0);
}

/// Distance from q to the segment (a, b), mm.
inline double distanceToSegment(const Point2& q, const Point2& a, const Point2& b) {
  return (q - a - nearestParameter(q, a, b) * (b - a)).norm();
}

}  // namespace explica::planar
