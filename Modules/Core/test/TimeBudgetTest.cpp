// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/TimeBudget.h"

#include <gtest/gtest.h>

namespace explica {
namespace {

/// Seconds of a whole command whose steps and output take as long as said: no clock is asked.
double wholeCommand(double limit, double start, double step, double growth, double output,
                    int frames) {
  const TimeBudget none(std::nullopt);
  EXPECT_TRUE(none.fits(1e9));
  TimeBudget budget(timeToIterate(limit, start, frames));
  double elapsed = 0;
  while (budget.fits(elapsed)) {
    elapsed += step;
    budget.stepTook(step);
    step *= growth;
  }
  return start + elapsed + output;
}

TEST(TimeBudget, HoldsForTheWholeCommandWithinAFifth) {
  constexpr double start = 0.25;
  for (const double limit : {2.0, 5.0, 10.0, 60.0}) {
    for (const int frames : {0, 5}) {
      const double most = start * (3 + 0.2 * frames);  // output that takes three times the start
      for (const double step : {0.01, 0.1, 0.3}) {
        // Steps may grow by a tenth each time, as where contacts come near.
        EXPECT_LE(wholeCommand(limit, start, step, 1.0, most, frames), limit + start + 1e-9);
        EXPECT_LE(wholeCommand(limit, start, step, 1.1, most, frames), 1.2 * limit);
        EXPECT_GE(wholeCommand(limit, start, step, 1.0, most, frames), limit + start - step - 1e-9);
      }
    }
  }
}

TEST(TimeBudget, LeavesTheFirstLookWhereTheStartUsedAllUp) {
  EXPECT_GT(timeToIterate(1, 100, 1000), 0);
  EXPECT_DOUBLE_EQ(timeToIterate(10, 1, 0), 7);
  EXPECT_DOUBLE_EQ(timeToIterate(10, 1, 10), 5);
}

}  // namespace
}  // namespace explica
