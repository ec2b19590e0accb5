// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/Trend.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::unfolding {
namespace {

constexpr double kSpared = 0.05;           // a strain at which lengths have much to spare ...
constexpr double kAimed = 0.9805 + 0.003;  // ... so that as much as can be is aimed at

std::vector<IterationRecord> resting(double visibility, double strain, double stretch = 1) {
  std::vector<IterationRecord> history(8);
  for (std::size_t n = 0; n < history.size(); ++n) {
    history[n].iteration = static_cast<int>(n);
    history[n].visibility = visibility;
    history[n].edgeStrainMean = strain;
    history[n].collarStretchMax = stretch;
  }
  return history;
}

TEST(Steering, IsTheRootOfWhatIsMissingOverWhatMayBe) {
  for (const double visibility : {0.9801, 0.982, 0.9835, 0.985, 0.987}) {
    EXPECT_NEAR(steer(resting(visibility, kSpared)).factor,
                std::sqrt((1 - visibility) / (1 - kAimed)), 1e-12)
        << visibility;
  }
  EXPECT_GT(steer(resting(0.982, kSpared)).factor, 1) << "too little is seen";
  EXPECT_LT(steer(resting(0.985, kSpared)).factor, 1) << "more is seen than lengths should pay for";
}

TEST(Steering, BringsSpringsToTheGoalInOneStep) {
  // Against springs the deficit falls with the square of the visibility term.
  const double deficit = 0.019, drive = 1;
  const double next = drive * steer(resting(1 - deficit / (drive * drive), kSpared)).factor;
  EXPECT_NEAR(1 - deficit / (next * next), kAimed, 1e-12);
}

TEST(Gaining, IsWhatAreasHaveToWaitFor) {
  const auto climbing = [](double step) {
    std::vector<IterationRecord> history = resting(0.9, kSpared);
    for (std::size_t n = 0; n < history.size(); ++n) {
      history[n].visibility += step * static_cast<double>(n);
    }
    return history;
  };
  EXPECT_TRUE(isGaining(climbing(0.0007))) << "0.0035 in five iterations";
  EXPECT_FALSE(isGaining(climbing(0.0005))) << "0.0025 in five iterations";
  EXPECT_FALSE(isGaining(climbing(-0.01)));
  std::vector<IterationRecord> young = climbing(0.01);
  young.resize(5);
  EXPECT_FALSE(isGaining(young)) << "nothing to compare with";
}

TEST(Steering, IsBounded) {
  EXPECT_DOUBLE_EQ(steer(resting(0.9, kSpared)).factor, 1.15);
  EXPECT_DOUBLE_EQ(steer(resting(0.999, kSpared)).factor, 1 / 1.15);
}

TEST(Steering, AimsLowerByHalfOfWhatStrainIsTooMuch) {
  EXPECT_NEAR(goalAt(kSpared), kAimed, 1e-12);
  EXPECT_NEAR(goalAt(kStrained), kSeen, 1e-12);
  EXPECT_NEAR(goalAt(kStrained + 0.01), kSeen - 0.005, 1e-12);
  EXPECT_NEAR(steer(resting(kSeen - 0.005, kStrained + 0.01)).factor, 1, 1e-12)
      << "both lack alike";
}

TEST(Steering, AsksWhereTheVisibilityIsGoing) {
  // Steps that halve: from 0.980 by as much again as the last one, to 0.9835.
  std::vector<IterationRecord> history = resting(0.98, kSpared);
  const std::size_t last = history.size() - 1;
  history[last - 2].visibility = 0.9695;
  history[last - 1].visibility = 0.9765;
  EXPECT_NEAR(steer(history).factor, 1, 1e-9);
  EXPECT_TRUE(steer(history).nearGoal);
}

TEST(TornCollar, ProlongsARunOnlyAsLongAsItGivesWay) {
  EXPECT_FALSE(isTorn(resting(0.98, kSpared, 7.9))) << "not stretched too far";
  EXPECT_FALSE(isTorn(resting(0.98, kSpared, 12.6))) << "caught, and staying as it is";
  std::vector<IterationRecord> history = resting(0.98, kSpared, 12.6);
  history.back().collarStretchMax = 12.5;
  EXPECT_TRUE(isTorn(history)) << "it is giving way back";
  history.back().collarStretchMax = 12.7;
  EXPECT_FALSE(isTorn(history)) << "it is stretched further";
  history.back().collarStretchMax = 7.9;
  EXPECT_FALSE(isTorn(history)) << "it has come back";
  history.resize(3);
  EXPECT_TRUE(isTorn(history)) << "nobody knows yet";
}

}  // namespace
}  // namespace explica::unfolding
