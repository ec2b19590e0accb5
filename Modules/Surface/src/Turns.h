// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace explica::surface {

/// Bits of a vertex's number so mixed that neighbours take turns in no order that they share.
[[nodiscard]] inline std::uint32_t mixedBits(std::int32_t v) {
  constexpr std::uint32_t kMix = 2654435761U;  // Knuth's multiplicative hash
  return static_cast<std::uint32_t>(v) * kMix >> 16;
}

}  // namespace explica::surface
