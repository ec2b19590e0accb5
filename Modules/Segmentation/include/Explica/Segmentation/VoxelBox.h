// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Errors.h"
#include "Explica/Core/Volume.h"

#include <algorithm>
#include <array>

namespace explica::segmentation {

/// A box of a grid's voxels: what lies in it can be worked on alone and put back, so that memory
/// follows the head instead of the field of view.
class VoxelBox {
 public:
  /// The box around the voxels that are not 0, with so many voxels of margin; all of the volume if
  /// there are none.
  template <class T>
  static VoxelBox around(const Volume<T>& volume, int margin) {
    std::array<int, 3> first = volume.grid.size, last = {-1, -1, -1};
    for (std::size_t v = 0; v < volume.size(); ++v) {
      if (volume[v] == T{0}) continue;
      const auto at = volume.grid.subscripts(v);
      for (int a = 0; a < 3; ++a) {
        first[a] = std::min(first[a], at[a]);
        last[a] = std::max(last[a], at[a]);
      }
    }
    return VoxelBox(volume.grid, first, last, margin);
  }

  [[nodiscard]] const Grid& grid() const { return grid_; }  ///< of the box
  [[nodiscard]] const Grid& whole() const { return whole_; }

  /// The box's part of a volume on the whole grid.
  /// @throws InvalidInput  the volume lies on another grid
  template <class T>
  [[nodiscard]] Volume<T> of(const Volume<T>& volume) const {
    if (!sameGrid(volume.grid, whole_)) throw InvalidInput("volume: lies on another grid");
    Volume<T> part(grid_);
    forRows([&](std::size_t inPart, std::size_t inWhole) {
      std::copy_n(volume.data.begin() + static_cast<std::ptrdiff_t>(inWhole), grid_.size[0],
                  part.data.begin() + static_cast<std::ptrdiff_t>(inPart));
    });
    return part;
  }

  /// A volume on the box's grid put back into the whole one.
  template <class T>
  [[nodiscard]] Volume<T> putBack(const Volume<T>& part, T outside = T{0}) const {
    Volume<T> volume(whole_, outside);
    forRows([&](std::size_t inPart, std::size_t inWhole) {
      std::copy_n(part.data.begin() + static_cast<std::ptrdiff_t>(inPart), grid_.size[0],
                  volume.data.begin() + static_cast<std::ptrdiff_t>(inWhole));
    });
    return volume;
  }

 private:
  VoxelBox(const Grid& whole, std::array<int, 3> first, std::array<int, 3> last, int margin)
      : whole_(whole), grid_(whole) {
    for (int a = 0; a < 3; ++a) {
      const bool empty = last[a] < first[a];
      first_[a] = empty ? 0 : std::max(0, first[a] - margin);
      const int end = empty ? whole.size[a] : std::min(whole.size[a], last[a] + 1 + margin);
      grid_.size[a] = end - first_[a];
    }
    grid_.origin = whole.toWorld(Vector(first_[0], first_[1], first_[2]));
  }

  template <class Work>
  void forRows(const Work& work) const {
    for (int k = 0; k < grid_.size[2]; ++k) {
      for (int j = 0; j < grid_.size[1]; ++j) {
        work(grid_.linear(0, j, k), whole_.linear(first_[0], first_[1] + j, first_[2] + k));
      }
    }
  }

  Grid whole_, grid_;
  std::array<int, 3> first_{};
};

}  // namespace explica::segmentation
