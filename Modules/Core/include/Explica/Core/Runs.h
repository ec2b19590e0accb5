// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <cstddef>

namespace explica {

/// Where the run of equal labels that begins at `from` ends, at most `end`.  Sixteen are compared
/// at once, since labels come in long runs.
[[nodiscard]] inline std::size_t runEnd(const Label* labels, std::size_t from, std::size_t end) {
  constexpr std::size_t kAtOnce = 16;
  const Label value = labels[from];
  for (; from + kAtOnce <= end; from += kAtOnce) {
    Label change = 0;
    for (std::size_t k = 0; k < kAtOnce; ++k) change |= labels[from + k] ^ value;
    if (change != 0) break;
  }
  while (from < end && labels[from] == value) ++from;
  return from;
}

}  // namespace explica
