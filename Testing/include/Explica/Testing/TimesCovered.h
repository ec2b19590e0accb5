// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <Eigen/Geometry>

#include <cmath>

namespace explica::testing {

/// How often a closed mesh about the origin covers the directions: the sum of its faces' solid
/// angles over 4 pi.
inline int timesCovered(const TriangleMesh& mesh) {
  double angle = 0;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const Point a = mesh.corner(f, 0).normalized(), b = mesh.corner(f, 1).normalized(),
                c = mesh.corner(f, 2).normalized();
    // tan(angle / 2) [Oosterom1983, Eq. 8]
    angle += 2 * std::atan2(a.dot(b.cross(c)), 1 + a.dot(b) + b.dot(c) + c.dot(a));
  }
  return static_cast<int>(std::lround(angle / (4 * kPi)));
}

}  // namespace explica::testing
