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

/// Calls visit(a, b) with the values of every two voxels that share a face, the lower one first.
template <class T, class Visit>
void forContacts(const Volume<T>& volume, const Visit& visit) {
  const auto& n = volume.grid.size;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        const T here = volume(i, j, k);
        if (i + 1 < n[0]) visit(here, volume(i + 1, j, k));
        if (j + 1 < n[1]) visit(here, volume(i, j + 1, k));
        if (k + 1 < n[2]) visit(here, volume(i, j, k + 1));
      }
    }
  }
}

}  // namespace explica
