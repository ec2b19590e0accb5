// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Parallel.h"

#include <algorithm>

// One thread in place of oneTBB's, which would have to be there for both processors; results do
// not hang on their number.
void explica::parallelForBlocks(std::size_t count, std::size_t grain,
                                const std::function<void(std::size_t, std::size_t)>& body) {
  grain = std::max<std::size_t>(grain, 1);
  for (std::size_t at = 0; at < count; at += grain) body(at, std::min(count, at + grain));
}

int explica::threadCount() {
  return 1;
}
