// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Grid.h"

#include "Explica/Core/Errors.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <cmath>
#include <string>

namespace explica {

Eigen::Matrix4d Grid::affine() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = direction * spacing.asDiagonal();
  m.topRightCorner<3, 1>() = origin;
  return m;
}

Grid gridFromAffine(const std::array<int, 3>& size, const Eigen::Matrix4d& affine) {
  constexpr double kRightAngleTolerance = 1e-4;  // cosine; float32 headers keep about 1e-6
  Grid grid;
  grid.size = size;
  grid.origin = affine.topRightCorner<3, 1>();
  for (int axis = 0; axis < 3; ++axis) {
    const Vector column = affine.block<3, 1>(0, axis);
    const double length = column.norm();
    if (!std::isfinite(length) || length <= 0) {
      throw InvalidInput("affine: axis " + std::to_string(axis) + " has length " +
                         std::to_string(length) + " mm; it must be positive and finite");
    }
    grid.spacing[axis] = length;
    grid.direction.col(axis) = column / length;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const double cosine = grid.direction.col(axis).dot(grid.direction.col((axis + 1) % 3));
    if (std::abs(cosine) > kRightAngleTolerance) {
      throw InvalidInput("affine: axes " + std::to_string(axis) + " and " +
                         std::to_string((axis + 1) % 3) + " are sheared (cosine " +
                         std::to_string(cosine) + "); resample to an orthogonal grid first");
    }
  }
  // Headers round the axes; the nearest orthonormal ones make writing and reading again exact.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(grid.direction,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  grid.direction = svd.matrixU() * svd.matrixV().transpose();
  return grid;
}

bool sameGrid(const Grid& a, const Grid& b, double tolerance) {
  if (a.size != b.size) return false;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector index((corner & 1) ? a.size[0] - 1 : 0, (corner & 2) ? a.size[1] - 1 : 0,
                       (corner & 4) ? a.size[2] - 1 : 0);
    const Vector difference = b.toIndex(a.toWorld(index)) - index;
    if (!(difference.cwiseAbs().maxCoeff() <= tolerance)) return false;
  }
  return true;
}

}  // namespace explica
