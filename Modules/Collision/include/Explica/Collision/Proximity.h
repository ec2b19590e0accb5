// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <array>
#include <cstdint>

namespace explica::collision {

using FourPoints = std::array<Point, 4>;
using Vector12 = Eigen::Matrix<double, 12, 1>;  ///< four points, x y z each

/// The two ways in which triangulated surfaces first touch.
enum class PairKind : std::uint8_t {
  VertexFace,  ///< point 0 against the triangle of points 1, 2, 3
  EdgeEdge     ///< segment of points 0, 1 against segment of points 2, 3
};

/// Nearest points of a pair as one linear combination of its four points.
///
/// difference = sum_i weights[i] x_i joins them.
struct Proximity {
  std::array<double, 4> weights = {0, 0, 0, 0};
  Vector difference = Vector::Zero();  ///< mm
  double squaredDistance = kInfinity;  ///< mm^2
};

/// Nearest points of a vertex and a face, or of two edges; degenerate faces and edges are allowed.
///
/// The computed distance may exceed the true one where two edges are nearly parallel: see
/// distanceBound().
[[nodiscard]] Proximity findProximity(PairKind kind, const FourPoints& x);

[[nodiscard]] double squaredDistance(PairKind kind, const FourPoints& x);

/// Gradient of the squared distance, mm: 2 w_i r for r the difference (envelope theorem).
[[nodiscard]] Vector12 squaredDistanceGradient(const Proximity& proximity);

/// A distance, mm, that the true one is not below; 0 if the pair may touch.
///
/// Round-off of positions and sums counts in full.  Parameters of nearly degenerate pairs are known
/// to eps / sin(angle), which moves the nearest points by eps of the spread; where the sine itself
/// is lost, an edge or end point is nearest up to sqrt(eps) of the spread.
[[nodiscard]] double distanceBound(PairKind kind, const FourPoints& x);

}  // namespace explica::collision
