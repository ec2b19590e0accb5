// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Grid.h"

#include <utility>
#include <vector>

namespace explica {

/// Values on a grid, i fastest.  T is a label, a scalar or a fixed-size vector (a map of points).
template <class T>
struct Volume {
  Grid grid;
  std::vector<T> data;  ///< grid.voxelCount() values

  Volume() = default;
  explicit Volume(Grid g, T value = T{}) : grid(std::move(g)), data(grid.voxelCount(), value) {}

  [[nodiscard]] T& operator()(int i, int j, int k) { return data[grid.linear(i, j, k)]; }
  [[nodiscard]] const T& operator()(int i, int j, int k) const {
    return data[grid.linear(i, j, k)];
  }
  [[nodiscard]] T& operator[](std::size_t v) { return data[v]; }
  [[nodiscard]] const T& operator[](std::size_t v) const { return data[v]; }
  [[nodiscard]] std::size_t size() const { return data.size(); }
};

}  // namespace explica
