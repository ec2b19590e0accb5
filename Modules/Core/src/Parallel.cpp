// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>

namespace explica {
namespace {

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
    body(block * grain, std::min(count, (block + 1) * grain));
  };
  if (blocks == 1) {
    runBlock(0);
    return;
  }
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, 1),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t b = range.begin(); b < range.end(); ++b) runBlock(b);
                    });
}

}  // namespace explica
