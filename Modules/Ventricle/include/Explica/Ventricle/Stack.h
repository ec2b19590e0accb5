// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"

#include <array>
#include <utility>

namespace explica::ventricle {

/// The axis along which thick slices are stacked, as hasThickSlices() has it; the last one where
/// there are none.
[[nodiscard]] int sliceAxis(const Grid& grid);

/// The same voxels in the same places, stored with this axis last: axes follow each other as before
/// (i, j, k, i), so that no image is mirrored.
template <class T>
[[nodiscard]] Volume<T> withLastAxis(Volume<T> volume, int last) {
  if (last == 2) return volume;
  const std::array<int, 3> axes = {(last + 1) % 3, (last + 2) % 3, last};
  Grid grid = volume.grid;
  for (int a = 0; a < 3; ++a) {
    grid.size[a] = volume.grid.size[axes[a]];
    grid.spacing[a] = volume.grid.spacing[axes[a]];
    grid.direction.col(a) = volume.grid.direction.col(axes[a]);
  }
  Volume<T> turned(grid);
  for (std::size_t v = 0; v < turned.size(); ++v) {
    const std::array<int, 3> from = grid.subscripts(v);
    std::array<int, 3> at{};
    for (int a = 0; a < 3; ++a) at[axes[a]] = from[a];
    turned[v] = volume(at[0], at[1], at[2]);
  }
  return turned;
}

/// Undoes withLastAxis(volume, last).
template <class T>
[[nodiscard]] Volume<T> withAxesBack(Volume<T> volume, int last) {
  return withLastAxis(std::move(volume), last == 2 ? 2 : 1 - last);
}

}  // namespace explica::ventricle
