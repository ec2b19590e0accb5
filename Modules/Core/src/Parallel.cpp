// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Parallel.h"

#include "Explica/Core/StopScope.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <memory>

#ifdef EXPLICA_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace explica {
namespace {

/// What TBB's library promises of a loop: all that was written before it is seen by each block, all
/// that the blocks write is seen after it.  The thread sanitizer cannot see this for itself, as the
/// library is not instrumented; elsewhere nothing is done.
class Promise {
 public:
  void given() { release(before_); }
  void taken() { acquire(before_); }
  void kept() { release(after_); }
  void met() { acquire(after_); }

 private:
#ifdef EXPLICA_THREAD_SANITIZER
  static void release(char& place) {
    __tsan_release(&place);
  }
  static void acquire(char& place) {
    __tsan_acquire(&place);
  }
#else
  static void release(char& /*place*/) {}
  static void acquire(char& /*place*/) {}
#endif

  char before_ = 0;
  char after_ = 0;
};

std::unique_ptr<tbb::global_control>& threadLimit() {
  static std::unique_ptr<tbb::global_control> limit;
  return limit;
}

}  // namespace

void setThreadCount(int count) {
  threadLimit().reset();
  if (count > 0) {
    threadLimit() = std::make_unique<tbb::global_control>(
        tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count));
  }
}

int threadCount() {
  return static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void parallelForBlocks(std::size_t count, std::size_t grain,
                       const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t blocks = (count + grain - 1) / grain;
  const auto runBlock = [&](std::size_t block) {
    checkpoint();
    body(block * grain, std::min(count, (block + 1) * grain));
  };
  if (blocks == 1) {
    runBlock(0);
    return;
  }
  Promise promise;
  promise.given();
  const Monitor* const monitor = StopScope::current();
  tbb::task_group_context group;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, blocks, 1),
      [&](const tbb::blocked_range<std::size_t>& range) {
        promise.taken();
        const StopScope scope(monitor);
        for (std::size_t b = range.begin(); b < range.end(); ++b) runBlock(b);
        promise.kept();
      },
      group);
  promise.met();
  // Where a loop around this one has ended by an exception, TBB leaves blocks out without a word.
  if (group.is_group_execution_cancelled()) throw Interrupted{};
}

void parallelTasks(std::size_t count, const std::function<void(std::size_t)>& body) {
  parallelForBlocks(count, 1, [&](std::size_t task, std::size_t) {
    tbb::this_task_arena::isolate([&] { body(task); });
  });
}

}  // namespace explica
