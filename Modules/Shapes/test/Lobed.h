// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Testing/Curves.h"

#include <cmath>

namespace explica::shapes {

/// A closed curve with lobes: radius 20 (1 + depth cos(lobes t + phase)).
inline planar::Curve lobed(int lobes, double depth, double phase) {
  planar::Curve curve = planar::makeCircle(400, 1);
  for (int v = 0; v < curve.vertexCount(); ++v) {
    const double t = 2 * kPi * v / curve.vertexCount();
    curve.positions.row(v) *= 20 * (1 + depth * std::cos(lobes * t + phase));
  }
  return curve;
}

}  // namespace explica::shapes
