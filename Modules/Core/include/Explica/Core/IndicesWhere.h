// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace explica {

/// The numbers below `count` that `is` accepts, ascending.
template <class Is>
[[nodiscard]] std::vector<std::int32_t> indicesWhere(std::size_t count, const Is& is) {
  std::vector<std::int32_t> found;
  for (std::size_t n = 0; n < count; ++n) {
    if (is(n)) found.push_back(static_cast<std::int32_t>(n));
  }
  return found;
}

}  // namespace explica
