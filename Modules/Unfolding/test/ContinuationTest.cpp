// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Continuation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::unfolding {
namespace {

constexpr double kSpared = 0.05;  // a strain at which lengths have much to spare

TEST(Steering, IsTheRootOfWhatIsMissingOverWhatMayBe) {
  const double aim = aimAt({}, kSpared);
  for (const double visibility : {0.9801, 0.982, 0.985, 0.987}) {
    EXPECT_NEAR(steering(visibility, aim), std::sqrt((1 - visibility) / (1 - aim)), 1e-12);
  }
  EXPECT_GT(steering(0.98, aim), 1) << "too little is seen";
  EXPECT_LT(steering(0.985, aim), 1) << "more is seen than lengths should pay for";
  EXPECT_DOUBLE_EQ(steering(0.9, aim), 1.15);
  EXPECT_DOUBLE_EQ(steering(0.999, aim), 1 / 1.15);
  EXPECT_DOUBLE_EQ(steering(0.999, 1), 1.15) << "a target that nothing reaches";
}

TEST(Steering, BringsSpringsToTheGoalInOneStep) {
  // Against springs the deficit falls with the square of the visibility term.
  const double deficit = 0.019, drive = 1, aim = aimAt({}, kSpared);
  const double next = drive * steering(1 - deficit / (drive * drive), aim);
  EXPECT_NEAR(1 - deficit / (next * next), aim, 1e-12);
}

TEST(Steering, GoalsThatCannotBothBeMetAreMissedInProportionOfTheTrade) {
  for (const double trade : {1.0, 2.0, 5.0}) {
    UnfoldOptions options;
    options.trade = trade;
    EXPECT_NEAR(aimAt(options, kGoalStrain), kGoalVisibility, 1e-12);
    EXPECT_NEAR(aimAt(options, kGoalStrain + 0.01), kGoalVisibility - 0.01 / trade, 1e-12);
    EXPECT_NEAR(merit(kGoalVisibility - 0.01 / trade, kGoalStrain + 0.01, kNaN, trade),
                -0.01 / trade, 1e-12)
        << "both miss alike";
  }
  EXPECT_LT(aimAt({}, kSpared), kGoalVisibility + 0.01) << "no more is seen than is asked for";
  UnfoldOptions target;
  target.targetVisibility = 0.9;
  EXPECT_NEAR(aimAt(target, 0.2), 0.9, 0.002) << "on the way to a target strain is no reason";
}

}  // namespace
}  // namespace explica::unfolding
