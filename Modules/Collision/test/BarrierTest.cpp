// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/Barrier.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::collision {
namespace {

TEST(Barrier, DerivativesEqualCentralDifferences) {
  const double range = 0.7;
  for (double d = 0.01; d < 0.69; d += 0.013) {
    const double h = 1e-5 * d;
    const BarrierValue at = evaluateBarrier(d, range);
    const BarrierValue before = evaluateBarrier(d - h, range),
                       after = evaluateBarrier(d + h, range);
    EXPECT_NEAR(at.slope, (after.value - before.value) / (2 * h), 1e-6 * (1 + std::abs(at.slope)));
    EXPECT_NEAR(at.curvature, (after.slope - before.slope) / (2 * h), 1e-6 * (1 + at.curvature));
  }
}

TEST(Barrier, IsTwiceContinuousWhereItEnds) {
  const BarrierValue inside = evaluateBarrier(1 - 1e-7, 1);
  EXPECT_NEAR(inside.value, 0, 1e-20);
  EXPECT_NEAR(inside.slope, 0, 1e-13);
  EXPECT_NEAR(inside.curvature, 0, 1e-6);
  EXPECT_EQ(evaluateBarrier(1, 1).curvature, 0);
  EXPECT_EQ(evaluateBarrier(2, 1).value, 0);
}

TEST(Barrier, SoftBarrierIsTwiceContinuousAndBounded) {
  const BarrierValue above = evaluateBarrier(0.1 + 1e-9, 1, 0.1),
                     below = evaluateBarrier(0.1 - 1e-9, 1, 0.1);
  EXPECT_NEAR(above.value, below.value, 1e-6);
  EXPECT_NEAR(above.slope, below.slope, 1e-5);
  EXPECT_NEAR(above.curvature, below.curvature, 1e-4);
  const BarrierValue contact = evaluateBarrier(0, 1, 0.1);
  EXPECT_NEAR(contact.value,
              evaluateBarrier(0.1, 1).value - 0.1 * evaluateBarrier(0.1, 1).slope +
                  0.005 * evaluateBarrier(0.1, 1).curvature,
              1e-12);
  EXPECT_LT(contact.slope, evaluateBarrier(0.1, 1).slope);
}

TEST(Barrier, GrowsWithoutBoundTowardsContactAndIsConvex) {
  double last = 0;
  for (double d = 0.9; d > 1e-12; d *= 0.7) {
    const BarrierValue b = evaluateBarrier(d, 1);
    EXPECT_GT(b.value, last);
    EXPECT_LE(b.slope, 0);
    EXPECT_GE(b.curvature, 0);
    last = b.value;
  }
  EXPECT_TRUE(std::isinf(evaluateBarrier(0, 1).value));
}

}  // namespace
}  // namespace explica::collision
