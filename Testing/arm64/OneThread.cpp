// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// One thread in place of oneTBB's, which would have to be there for both processors; results do
// not hang on their number.

#include "Explica/Core/Parallel.h"

#include <algorithm>

namespace explica {

void setThreadCount(int) {}

int threadCount() {
  return 1;
}

void parallelForBlocks(std::size_t count, std::size_t grain,
                       const std::function<void(std::size_t, std::size_t)>& body) {
  grain = std::max<std::size_t>(grain, 1);
  for (std::size_t at = 0; at < count; at += grain) body(at, std::min(count, at + grain));
}

}  // namespace explica
