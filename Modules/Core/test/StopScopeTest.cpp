// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/StopScope.h"

#include "Explica/Core/Parallel.h"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <atomic>
#include <stdexcept>

namespace explica {
namespace {

/// Wants a stop from the n-th time on that it is asked.
class StopAt {
 public:
  explicit StopAt(int n) {
    monitor_.stopWanted = [this, n] { return ++asked_ >= n; };
  }
  [[nodiscard]] const Monitor& monitor() const { return monitor_; }
  [[nodiscard]] int asked() const { return asked_; }

 private:
  std::atomic<int> asked_ = 0;
  Monitor monitor_;
};

TEST(StopScope, WithoutAMonitorNothingIsAsked) {
  const StopAt stop(1);
  EXPECT_NO_THROW(checkpoint());
  const StopScope outer(&stop.monitor());
  const StopScope kept(nullptr);
  EXPECT_NO_THROW(checkpoint());
  int visited = 0;
  parallelFor(10, 20, [&](std::size_t) { ++visited; });
  EXPECT_EQ(visited, 10);
  EXPECT_EQ(stop.asked(), 0);
}

TEST(StopScope, EndsWithItsBlock) {
  const StopAt stop(1);
  {
    const StopScope scope(&stop.monitor());
    EXPECT_THROW(checkpoint(), Interrupted);
  }
  EXPECT_NO_THROW(checkpoint());
}

TEST(StopScope, EveryBlockOfAParallelLoopIsOneCheckpointWithAnyNumberOfThreads) {
  for (const int threads : {1, 2, 4}) {
    setThreadCount(threads);
    const StopAt stop(1000);
    const StopScope scope(&stop.monitor());
    parallelFor(1005, 10, [](std::size_t) {});
    EXPECT_EQ(stop.asked(), 101);
  }
  setThreadCount(0);
}

TEST(StopScope, AStoppedLoopDoesAsManyBlocksAsItWasLet) {
  for (const int threads : {1, 2, 4}) {
    setThreadCount(threads);
    const StopAt stop(31);
    const StopScope scope(&stop.monitor());
    std::atomic<int> blocks = 0;
    EXPECT_THROW(parallelForBlocks(1000, 10, [&](std::size_t, std::size_t) { ++blocks; }),
                 Interrupted);
    EXPECT_EQ(blocks, 30);
  }
  setThreadCount(0);
}

TEST(StopScope, ReachesLoopsWithinLoopsOnEveryThread) {
  const StopAt stop(1000);
  const StopScope scope(&stop.monitor());
  parallelFor(8, 1, [](std::size_t) { parallelFor(40, 10, [](std::size_t) {}); });
  EXPECT_EQ(stop.asked(), 8 + 8 * 4);
}

/// As when another block of the loop around it has thrown: TBB then leaves out blocks, and the loop
/// must not return as if they had been done.
TEST(StopScope, ALoopWithinALoopThatHasEndedDoesNotReturn) {
  tbb::task_group_context group;
  std::atomic<int> ended = 0;
  const auto body = [&](std::size_t /*n*/) {
    group.cancel_group_execution();
    try {
      parallelFor(1000, 1, [](std::size_t) {});
    } catch (const Interrupted&) {
      ++ended;
    }
  };
  tbb::parallel_for(std::size_t{0}, std::size_t{2}, body, group);
  EXPECT_GE(ended.load(), 1);
}

TEST(StopScope, IsNoFaultOfTheData) {
  const StopAt stop(1);
  const StopScope scope(&stop.monitor());
  bool interrupted = false;
  try {
    try {
      checkpoint();
    } catch (const std::exception&) {
      FAIL() << "a stop was taken for an error";
    }
  } catch (const Interrupted&) {
    interrupted = true;
  }
  EXPECT_TRUE(interrupted);
}

}  // namespace
}  // namespace explica
