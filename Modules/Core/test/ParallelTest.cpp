// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Parallel.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <stdexcept>

namespace explica {
namespace {

double sumOfSquareRoots() {
  return parallelSum(100003, 1000, 0.0, [](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += std::sqrt(static_cast<double>(i)) * 1e-3;
    return sum;
  });
}

TEST(Parallel, SumHasEqualBitsForEveryThreadCount) {
  setThreadCount(1);
  const double one = sumOfSquareRoots();
  for (const int threads : {2, 4}) {
    setThreadCount(threads);
    for (int repeat = 0; repeat < 5; ++repeat) EXPECT_EQ(sumOfSquareRoots(), one);
  }
  setThreadCount(0);
}

TEST(Parallel, EveryIndexIsVisitedOnce) {
  std::vector<int> visits(10007, 0);
  parallelFor(visits.size(), 64, [&](std::size_t i) { ++visits[i]; });
  for (const int v : visits) ASSERT_EQ(v, 1);
}

TEST(Parallel, ExceptionReachesTheCaller) {
  EXPECT_THROW(parallelFor(1000, 10,
                           [](std::size_t i) {
                             if (i == 567) throw std::runtime_error("stop");
                           }),
               std::runtime_error);
}

TEST(Parallel, TasksHaveLoopsOfTheirOwn) {
  for (const int threads : {1, 2, 4}) {
    setThreadCount(threads);
    std::array<double, 5> sums{};
    parallelTasks(sums.size(), [&](std::size_t task) { sums[task] = sumOfSquareRoots(); });
    for (const double sum : sums) EXPECT_EQ(sum, sumOfSquareRoots());
    EXPECT_THROW(parallelTasks(2,
                               [](std::size_t task) {
                                 if (task == 1) throw std::runtime_error("stop");
                               }),
                 std::runtime_error);
  }
  setThreadCount(0);
}

TEST(Parallel, ThreadCountIsWhatWasAskedFor) {
  setThreadCount(1);
  EXPECT_EQ(threadCount(), 1);
  setThreadCount(0);
  EXPECT_GE(threadCount(), 1);
}

}  // namespace
}  // namespace explica
