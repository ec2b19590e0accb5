// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/Curve.h"

#include <cmath>

namespace explica::planar {

/// Ellipse with semi-axes a (along x) and b, vertices at equal parameters.
inline Curve makeEllipse(int edges, double a, double b) {
  Curve ellipse;
  ellipse.positions.resize(edges, 2);
  for (int k = 0; k < edges; ++k) {
    const double angle = 2 * kPi * k / edges;
    ellipse.positions.row(k) << a * std::cos(angle), b * std::sin(angle);
  }
  return ellipse;
}

/// Circle by `edges` chords, counter-clockwise, vertices on the circle.
inline Curve makeCircle(int edges, double radius, const Point2& centre = Point2::Zero()) {
  Curve circle = makeEllipse(edges, radius, radius);
  circle.positions.rowwise() += centre.transpose();
  return circle;
}

}  // namespace explica::planar
