// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/Curve.h"

#include <functional>

namespace explica::planar {

/// Gradient of a function of a curve's positions by central differences.
inline Positions2 centralDifferences(const Curve& curve,
                                     const std::function<double(const Curve&)>& function,
                                     double step) {
  Positions2 gradient(curve.vertexCount(), 2);
  Curve moved = curve;
  for (int v = 0; v < curve.vertexCount(); ++v) {
    for (int axis = 0; axis < 2; ++axis) {
      moved.positions(v, axis) = curve.positions(v, axis) + step;
      const double up = function(moved);
      moved.positions(v, axis) = curve.positions(v, axis) - step;
      const double down = function(moved);
      moved.positions(v, axis) = curve.positions(v, axis);
      gradient(v, axis) = (up - down) / (2 * step);
    }
  }
  return gradient;
}

}  // namespace explica::planar
