// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Grid.h"

#include <array>
#include <vector>

namespace explica::segmentation {

/// Sums of samples under a Gaussian window, on blocks of a share of its width over the box of some
/// voxels; between the blocks' centres values are interpolated.
class BlockWindow {
 public:
  /// @param voxel           linear indices: the box that holds them
  /// @param width           standard deviation of the window, mm
  /// @param blocksPerWidth  how many blocks that is
  BlockWindow(const Grid& grid, const std::vector<std::size_t>& voxel, double width,
              double blocksPerWidth = 4);

  [[nodiscard]] std::size_t count() const;

  /// One sum a block; a sample at the block's centre counts once, others as far as they are near.
  /// @param voxel  of the samples, in the box, ascending
  [[nodiscard]] std::vector<double> sums(const std::vector<std::size_t>& voxel,
                                         const std::vector<float>& values) const;

  /// The block values at voxels of the box, trilinear.
  [[nodiscard]] std::vector<float> atVoxels(const std::vector<double>& values,
                                            const std::vector<std::size_t>& voxel) const;

 private:
  /// Where a voxel of the box lies along an axis.
  struct Place {
    int block;      ///< that it is in
    int low, high;  ///< those between whose centres it lies
    double share;   ///< of the higher one
  };
  [[nodiscard]] const Place& placeOf(const std::array<int, 3>& at, int axis) const {
    return places_[axis][at[axis] - first_[axis]];
  }
  [[nodiscard]] std::size_t linear(int i, int j, int k) const;
  /// The row of blocks between four.
  void blend(const std::vector<double>& values, const Place& y, const Place& z,
             std::vector<double>& row) const;
  void smoothAlong(std::vector<double>& values, int axis) const;

  Grid grid_;
  double width_;
  std::array<int, 3> first_;  ///< voxel of the box
  std::array<int, 3> step_;   ///< voxels a block
  std::array<int, 3> size_;   ///< blocks
  std::array<std::vector<Place>, 3> places_;
};

}  // namespace explica::segmentation
