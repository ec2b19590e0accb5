// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace explica::repulsion {

/// Rule for means over a simplex: barycentric coordinates of each point, a row, and its weight.
struct Rule {
  static constexpr int kMostPoints = 16;
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, kMostPoints, 3> lambda;
  Eigen::Array<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostPoints, 1> weight;
};

/// Symmetric rules on the triangle, weights sum to 1, by degree of exactness [Dunavant1985].
[[nodiscard]] const Rule& triangleRule3();   ///< degree 2
[[nodiscard]] const Rule& triangleRule7();   ///< degree 5
[[nodiscard]] const Rule& triangleRule16();  ///< degree 8

/// Gauss-Legendre on the segment: coordinates (1 - s, s, 0); degree 2 n - 1.
[[nodiscard]] const Rule& segmentRule2();
[[nodiscard]] const Rule& segmentRule3();
[[nodiscard]] const Rule& segmentRule5();

/// The point itself.
[[nodiscard]] const Rule& pointRule();

}  // namespace explica::repulsion
