// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Base64.h"

#include <array>
#include <cstdint>
#include <cstring>

namespace explica {

std::string base64(std::string_view bytes) {
  static const auto kPairs = [] {  // 12 bits at once
    std::array<std::array<char, 2>, 4096> pairs{};
    for (std::size_t n = 0; n < pairs.size(); ++n) pairs[n] = {kBase64[n >> 6], kBase64[n & 63]};
    return pairs;
  }();
  const auto byte = [&](std::size_t at) -> std::uint32_t {
    return at < bytes.size() ? static_cast<std::uint8_t>(bytes[at]) : 0;
  };
  std::string text((bytes.size() + 2) / 3 * 4, '=');
  char* to = text.data();
  for (std::size_t i = 0; i < bytes.size(); i += 3, to += 4) {
    const std::uint32_t bits = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    std::memcpy(to, kPairs[bits >> 12].data(), 2);
    std::memcpy(to + 2, kPairs[bits & 4095].data(), 2);
  }
  for (std::size_t filled = bytes.size(); filled % 3 != 0; ++filled) *--to = '=';
  return text;
}

}  // namespace explica
