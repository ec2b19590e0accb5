// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/Barrier.h"

#include <cmath>
#include <limits>

namespace explica::collision {

BarrierValue evaluateBarrier(double distance, double range, double softBelow) {
  if (!(distance < range)) return {};
  if (distance < softBelow * range) {
    const BarrierValue edge = evaluateBarrier(softBelow * range, range);
    const double inside = distance - softBelow * range;
    return {edge.value + inside * (edge.slope + 0.5 * inside * edge.curvature),
            edge.slope + inside * edge.curvature, edge.curvature};
  }
  if (!(distance > 0)) return {std::numeric_limits<double>::infinity(), 0, 0};
  const double y = distance / range, z = y - 1, logarithm = std::log(y);
  return {-z * z * logarithm, -(2 * z * logarithm + z * z / y) / range,
          -(2 * logarithm + 4 * z / y - z * z / (y * y)) / (range * range)};
}

}  // namespace explica::collision
