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
///
/// With softBelow > 0 the barrier goes on below softBelow * r as its own quadratic there: force and
/// stiffness stay bounded, a Newton step opens a pair from any distance at once instead of doubling
/// it, and what keeps surfaces apart is continuous collision detection alone.
/// @param distance   mm, > 0, or >= 0 with softBelow > 0
/// @param range      r, mm, > 0
/// @param softBelow  in [0, 1)
[[nodiscard]] BarrierValue evaluateBarrier(double distance, double range, double softBelow = 0);

}  // namespace explica::collision
