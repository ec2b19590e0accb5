// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace explica::unfolding {

/// Which corners of faces, springs or contacts lie at each unknown.
///
/// Whoever adds up what these contribute can so do it unknown by unknown, on several threads, and
/// in the order in which a walk along them would: every sum is the same for any number of threads.
class Around {
 public:
  struct Corner {
    std::int32_t item;
    std::int32_t place;  ///< of the unknown among the item's vertices
  };

  Around() = default;
  /// @param unknown     row of each vertex, or -1 of those that stay
  /// @param verticesOf  verticesOf(n) gives the vertices of item n as an array
  template <class VerticesOf>
  Around(std::size_t items, const std::vector<std::int32_t>& unknown, const VerticesOf& verticesOf);

  /// Rows of the system up to the last that has a corner.
  [[nodiscard]] std::size_t rows() const { return begin_.size() - 1; }
  /// Ascending by item.
  [[nodiscard]] std::span<const Corner> at(std::size_t row) const {
    return std::span(corners_).subspan(static_cast<std::size_t>(begin_[row]),
                                       static_cast<std::size_t>(begin_[row + 1] - begin_[row]));
  }

 private:
  std::vector<std::int32_t> begin_ = {0};
  std::vector<Corner> corners_;
};

template <class VerticesOf>
Around::Around(std::size_t items, const std::vector<std::int32_t>& unknown,
               const VerticesOf& verticesOf) {
  std::int32_t last = -1;
  for (const std::int32_t row : unknown) last = std::max(last, row);
  begin_.assign(static_cast<std::size_t>(last) + 2, 0);
  const auto visit = [&](const auto& take) {
    for (std::size_t n = 0; n < items; ++n) {
      std::int32_t place = 0;
      for (const std::int32_t vertex : verticesOf(n)) {
        if (unknown[vertex] >= 0) take(unknown[vertex], static_cast<std::int32_t>(n), place);
        ++place;
      }
    }
  };
  visit([&](std::int32_t row, std::int32_t, std::int32_t) { ++begin_[row + 1]; });
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  corners_.resize(static_cast<std::size_t>(begin_.back()));
  std::vector<std::int32_t> next(begin_.begin(), begin_.end() - 1);
  visit([&](std::int32_t row, std::int32_t item, std::int32_t place) {
    corners_[next[row]++] = {item, place};
  });
}

}  // namespace explica::unfolding
