// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Core/Grid.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace explica {
namespace {

Grid obliqueGrid() {
  Grid grid;
  grid.size = {5, 7, 3};
  grid.spacing = {0.7, 1.1, 3.0};
  grid.direction = (Eigen::AngleAxisd(0.4, Vector(1, 2, 3).normalized())).toRotationMatrix() *
                   Vector(-1, 1, 1).asDiagonal();
  grid.origin = {10, -20, 30};
  return grid;
}

TEST(Grid, IndexAndWorldAreInverse) {
  const Grid grid = obliqueGrid();
  const Vector index(1.25, 6.5, 0.75);
  EXPECT_LT((grid.toIndex(grid.toWorld(index)) - index).norm(), 1e-12);
}

TEST(Grid, LinearIndexRoundTrips) {
  const Grid grid = obliqueGrid();
  for (std::size_t v = 0; v < grid.voxelCount(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    ASSERT_TRUE(grid.contains(i, j, k));
    ASSERT_EQ(grid.linear(i, j, k), v);
  }
}

TEST(Grid, AffineRoundTripsThroughObliqueMirroredAxes) {
  const Grid grid = obliqueGrid();
  const Grid back = gridFromAffine(grid.size, grid.affine());
  EXPECT_TRUE(sameGrid(grid, back, 1e-12));
  EXPECT_LT((back.spacing - grid.spacing).norm(), 1e-12);
}

TEST(Grid, ShearAndZeroSpacingAreRefused) {
  Eigen::Matrix4d sheared = obliqueGrid().affine();
  sheared.block<3, 1>(0, 0) += 0.1 * sheared.block<3, 1>(0, 1);
  EXPECT_THROW((void)gridFromAffine({2, 2, 2}, sheared), InvalidInput);
  Eigen::Matrix4d flat = obliqueGrid().affine();
  flat.col(2).setZero();
  EXPECT_THROW((void)gridFromAffine({2, 2, 2}, flat), InvalidInput);
}

TEST(Grid, SameGridNoticesShiftAndSize) {
  const Grid grid = obliqueGrid();
  Grid shifted = grid;
  shifted.origin[0] += 0.01;
  EXPECT_FALSE(sameGrid(grid, shifted));
  Grid longer = grid;
  longer.size[2] += 1;
  EXPECT_FALSE(sameGrid(grid, longer));
}

}  // namespace
}  // namespace explica
