// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Parallel.h"

#include <gtest/gtest.h>

#include <atomic>
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

/// Each task waits for loops of its own meanwhile, in which a thread could take the next one up.
TEST(Parallel, AThreadIsInOneTaskAtATime) {
  for (const int threads : {1, 2, 4}) {
    setThreadCount(threads);
    std::atomic<int> done = 0, nested = 0;
    parallelTasks(64, [&](std::size_t) {
      thread_local int depth = 0;
      nested += depth;
      ++depth;
      for (int loop = 0; loop < 20; ++loop) {
        done += static_cast<int>(parallelSum(64, 1, 0.0, [](std::size_t i, std::size_t) {
          return std::sin(static_cast<double>(i)) < 2 ? 1.0 : 0.0;
        }));
      }
      --depth;
    });
    EXPECT_EQ(done, 64 * 20 * 64);
    EXPECT_EQ(nested, 0);
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
