// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>

namespace explica {

/// Lines of a box of elements along one axis, where the first axis is stored fastest: element s of
/// line l is at begin(l) + s * stride.
struct GridLines {
  std::size_t count;   ///< lines
  std::size_t stride;  ///< elements between neighbours in a line
  int length;          ///< elements a line

  GridLines(const std::array<int, 3>& size, int axis)
      : count(1), stride(1), length(size[static_cast<std::size_t>(axis)]) {
    for (int a = 0; a < 3; ++a) {
      const auto n = static_cast<std::size_t>(size[static_cast<std::size_t>(a)]);
      if (a != axis) count *= n;
      if (a < axis) stride *= n;
    }
  }
  [[nodiscard]] std::size_t begin(std::size_t line) const {
    return (line / stride) * stride * static_cast<std::size_t>(length) + line % stride;
  }
};

}  // namespace explica
