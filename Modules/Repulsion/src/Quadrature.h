// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

namespace explica::repulsion {

/// A point of a rule for means over a simplex: barycentric coordinates and weight.
struct RulePoint {
  std::array<double, 3> lambda;
  double weight;
};
using Rule = std::span<const RulePoint>;

/// Symmetric rules on the triangle, weights sum to 1, by degree of exactness [Dunavant1985].
[[nodiscard]] Rule triangleRule3();   ///< degree 2
[[nodiscard]] Rule triangleRule7();   ///< degree 5
[[nodiscard]] Rule triangleRule12();  ///< degree 6
[[nodiscard]] Rule triangleRule16();  ///< degree 8

/// Gauss-Legendre on the segment: coordinates (1 - s, s, 0); degree 2 n - 1.
[[nodiscard]] Rule segmentRule2();
[[nodiscard]] Rule segmentRule3();
[[nodiscard]] Rule segmentRule5();

/// The point itself.
[[nodiscard]] Rule pointRule();

}  // namespace explica::repulsion
