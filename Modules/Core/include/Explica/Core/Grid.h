// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <array>
#include <cstddef>

namespace explica {

/// The lattice of a volume and where it lies in the world.
///
/// Voxel (i, j, k) has its centre at origin + direction * diag(spacing) * (i, j, k), RAS mm.
/// A grid whose size[2] is 1 is two-dimensional: algorithms then work in its plane.
struct Grid {
  std::array<int, 3> size = {0, 0, 0};                      ///< voxels along i, j, k
  Vector spacing = Vector::Ones();                          ///< mm, each > 0
  Eigen::Matrix3d direction = Eigen::Matrix3d::Identity();  ///< orthonormal columns: axes i, j, k
  Point origin = Point::Zero();                             ///< centre of voxel (0, 0, 0)

  [[nodiscard]] std::size_t voxelCount() const {
    return static_cast<std::size_t>(size[0]) * size[1] * size[2];
  }
  [[nodiscard]] int dimension() const { return size[2] == 1 ? 2 : 3; }
  [[nodiscard]] double voxelVolume() const { return spacing.prod(); }

  /// Position of a voxel in storage order: i runs fastest.
  [[nodiscard]] std::size_t linear(int i, int j, int k) const {
    return i + static_cast<std::size_t>(size[0]) * (j + static_cast<std::size_t>(size[1]) * k);
  }
  [[nodiscard]] std::array<int, 3> subscripts(std::size_t linearIndex) const {
    const std::size_t row = linearIndex / size[0];
    return {static_cast<int>(linearIndex % size[0]), static_cast<int>(row % size[1]),
            static_cast<int>(row / size[1])};
  }
  /// Positions of the voxels that share a face with one: below and above along each axis; -1 where
  /// the grid ends.
  [[nodiscard]] std::array<std::int64_t, 6> neighbours(std::size_t linearIndex) const {
    const std::array<int, 3> at = subscripts(linearIndex);
    std::array<std::int64_t, 6> found;
    std::int64_t stride = 1;
    for (int axis = 0; axis < 3; stride *= size[axis++]) {
      const auto here = static_cast<std::int64_t>(linearIndex);
      found[2 * axis] = at[axis] > 0 ? here - stride : -1;
      found[2 * axis + 1] = at[axis] + 1 < size[axis] ? here + stride : -1;
    }
    return found;
  }
  [[nodiscard]] bool contains(int i, int j, int k) const {
    return i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2];
  }

  /// World point of a continuous index, RAS mm.
  [[nodiscard]] Point toWorld(const Vector& index) const {
    return origin + direction * spacing.cwiseProduct(index);
  }
  /// Continuous index of a world point.
  [[nodiscard]] Vector toIndex(const Point& world) const {
    return (direction.transpose() * (world - origin)).cwiseQuotient(spacing);
  }
  /// World vector of a vector given in millimetres along the grid's axes.
  [[nodiscard]] Vector axesToWorld(const Vector& alongAxes) const { return direction * alongAxes; }

  /// Index-to-world matrix, 4 x 4, as NIfTI's affine.
  [[nodiscard]] Eigen::Matrix4d affine() const;
};

/// Grid of an affine whose columns are orthogonal up to rounding; the grid's axes are the nearest
/// orthonormal ones.
/// @throws InvalidInput  zero, non-finite or sheared (beyond 1e-4 of a right angle) columns
[[nodiscard]] Grid gridFromAffine(const std::array<int, 3>& size, const Eigen::Matrix4d& affine);

/// True if both grids have equal sizes and place every voxel within `tolerance` voxels of each
/// other.
[[nodiscard]] bool sameGrid(const Grid& a, const Grid& b, double tolerance = 1e-3);

}  // namespace explica
