// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica::collision {

/// Value and derivatives of the clamped log barrier at one distance.
struct BarrierValue {
  double value = 0;      ///< no unit; 0 from `range` on, infinite at contact
  double slope = 0;      ///< mm^-1, <= 0
  double curvature = 0;  ///< mm^-2, >= 0
};

/// b(d) = -(d/r - 1)^2 ln(d/r) for 0 < d < r, 0 beyond: twice continuously differentiable at r,
/// after [Li2020, Eq. 6] with the distance in place of its square.
/// @param distance  mm, > 0
/// @param range     r, mm, > 0
[[nodiscard]] BarrierValue evaluateBarrier(double distance, double range);

}  // namespace explica::collision
