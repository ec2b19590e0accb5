// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace explica {

/// The value that would have this index if the values were sorted; changes their order.
/// @param index  below their number
template <class T>
[[nodiscard]] T nthSmallest(std::vector<T>& values, std::size_t index) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(index);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The quantile of a share from 0 to 1, without interpolation: the value at or below it.
/// @param values  at least one
template <class T>
[[nodiscard]] T quantileOf(std::vector<T> values, double share) {
  return nthSmallest(values,
                     static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

/// The median, of an even number the larger of the two in the middle.
/// @param values  at least one
template <class T>
[[nodiscard]] T upperMedian(std::vector<T> values) {
  return nthSmallest(values, values.size() / 2);
}

}  // namespace explica
