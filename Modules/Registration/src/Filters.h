// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Parallel.h"
#include "Explica/Core/Volume.h"

#include <array>
#include <cstddef>

namespace explica::registration {

/// Convolution with a Gaussian of this standard deviation, mm; what lies outside counts as the
/// border's value.  Not longer than three standard deviations.
[[nodiscard]] Volume<float> smoothed(Volume<float> volume, double sigma);

/// Mean over a box of 2 r + 1 voxels a side, cut at the border.
[[nodiscard]] Volume<float> boxMean(Volume<float> volume, int radius);

/// The eight voxels around a continuous index, held within the grid, and the shares between them.
class Cell {
 public:
  Cell(const Grid& grid, const Vector& index);
  /// Trilinear value of a volume on that grid.
  [[nodiscard]] float of(const Volume<float>& volume) const;

 private:
  std::size_t first_ = 0;
  std::array<std::size_t, 3> step_;
  std::array<float, 3> share_;
};

/// Trilinear value at a continuous index; `outside` beyond half a voxel from the voxels.
[[nodiscard]] float valueAt(const Volume<float>& volume, const Vector& index, float outside = 0);

/// Calls work(i, j, k) for each voxel of the grid, planes in parallel.
template <class Work>
void forLattice(const Grid& grid, const Work& work) {
  parallelFor(static_cast<std::size_t>(grid.size[2]), 1, [&](std::size_t k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) work(i, j, static_cast<int>(k));
    }
  });
}

/// The volume that has value(index) at each voxel.
template <class Value>
[[nodiscard]] Volume<float> volumeBy(const Grid& grid, const Value& value) {
  Volume<float> volume(grid);
  forLattice(grid, [&](int i, int j, int k) { volume(i, j, k) = value(Vector(i, j, k)); });
  return volume;
}

/// Grid of cubes of this size along the axes of another, over a box of continuous indices of it.
[[nodiscard]] Grid cubicGrid(const Grid& like, const Vector& low, const Vector& high,
                             double spacing);

/// The volume on another grid, smoothed first as far as its voxels are smaller than the grid's.
/// 0 outside.
[[nodiscard]] Volume<float> resampled(const Volume<float>& volume, const Grid& grid);

/// The whole volume in cubes of this size, as resampled().
[[nodiscard]] Volume<float> inCubes(const Volume<float>& volume, double spacing);

/// Voxels in which there is a head, roughly: 1 where brighter than the mean, else 0.
[[nodiscard]] Volume<float> headOf(const Volume<float>& image);

/// Centre of the voxels above 0, RAS mm.
[[nodiscard]] Point centreOf(const Volume<float>& head);

}  // namespace explica::registration
