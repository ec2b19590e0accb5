// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/Curve.h"

#include <initializer_list>

namespace explica::planar {

/// Closed curve through the points in order.
inline Curve polygon(std::initializer_list<Point2> points) {
  Curve curve;
  curve.positions.resize(static_cast<Eigen::Index>(points.size()), 2);
  Eigen::Index row = 0;
  for (const Point2& p : points) curve.positions.row(row++) = p.transpose();
  return curve;
}

}  // namespace explica::planar
