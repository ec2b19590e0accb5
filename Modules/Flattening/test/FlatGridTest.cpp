// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/FlatGrid.h"

#include "Explica/Core/Errors.h"
#include "Explica/Flattening/Flatten.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace explica::flattening {
namespace {

/// A folded cap between two surfaces, and its flat map.
FlatSheet foldedSheet() {
  const TriangleMesh inner = geometry::makeFoldedSphere(5, 30, 0.12, 5);
  std::vector<std::int32_t> faces;
  for (Eigen::Index f = 0; f < inner.faceCount(); ++f) {
    if (inner.corner(f, 0).z() > 10 && inner.corner(f, 1).z() > 10 && inner.corner(f, 2).z() > 10) {
      faces.push_back(static_cast<std::int32_t>(f));
    }
  }
  const Disc disc = discOf(inner, faces);
  const FlatMap map = flatten(disc);
  FlatSheet sheet{disc.mesh.faces, Positions::Zero(disc.mesh.vertexCount(), 3), disc.mesh.positions,
                  1.1 * disc.mesh.positions};
  sheet.flat.leftCols<2>() = map.positions;
  return sheet;
}

/// The grid's point at u, v (mm) and depth (0 to 1), trilinear.
std::optional<Point> pointAt(const Volume<Eigen::Vector3f>& grid, const Eigen::Vector3f& uvd) {
  Vector index;
  for (int axis = 0; axis < 2; ++axis) {
    index[axis] = (uvd[axis] - grid.grid.origin[axis]) / grid.grid.spacing[axis];
  }
  index[2] = uvd[2] * (grid.grid.size[2] - 1);
  Point point = Point::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    std::array<int, 3> at{};
    for (int axis = 0; axis < 3; ++axis) {
      const int low =
          std::clamp(static_cast<int>(std::floor(index[axis])), 0, grid.grid.size[axis] - 2);
      const bool upper = corner >> axis & 1;
      weight *= upper ? index[axis] - low : 1 - (index[axis] - low);
      at[axis] = low + upper;
    }
    const Eigen::Vector3f& p = grid(at[0], at[1], at[2]);
    if (!p.allFinite()) return {};
    point += weight * p.cast<double>();
  }
  return point;
}

TEST(FlatGrid, HasSquareCellsAndNoEmptyOneInsideTheMap) {
  const FlatSheet sheet = foldedSheet();
  FlatGridOptions options;
  options.cell = 0.7;
  const auto grid = flatGrid(sheet, options);
  EXPECT_DOUBLE_EQ(grid.grid.spacing[0], 0.7);
  EXPECT_DOUBLE_EQ(grid.grid.spacing[1], 0.7);
  EXPECT_EQ(grid.grid.size[2], 5);
  // In every row the cells of a disc without holes that curves outward are one run.
  double filled = 0;
  for (int j = 0; j < grid.grid.size[1]; ++j) {
    for (int i = 0; i < grid.grid.size[0]; ++i) {
      filled += grid(i, j, 0).allFinite();
      EXPECT_EQ(grid(i, j, 0).allFinite(), grid(i, j, 4).allFinite());
    }
  }
  double area = 0;
  for (Eigen::Index f = 0; f < sheet.faces.rows(); ++f) {
    const auto a = sheet.flat.row(sheet.faces(f, 0)), b = sheet.flat.row(sheet.faces(f, 1)),
               c = sheet.flat.row(sheet.faces(f, 2));
    area += ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
  }
  EXPECT_NEAR(filled * 0.49, area, 0.01 * area);
}

TEST(FlatGrid, CellsOnVerticesAndSidesAreFilled) {
  const TriangleMesh plane = geometry::makeRectangle(8, 8, 8, 8);
  const FlatSheet sheet{plane.faces, plane.positions, plane.positions, plane.positions};
  FlatGridOptions options;
  options.cell = 0.5;
  options.depths = 1;
  const auto grid = flatGrid(sheet, options);
  ASSERT_EQ(grid.grid.size[0], 17);
  for (std::size_t n = 0; n < grid.size(); ++n) {
    const auto [i, j, k] = grid.grid.subscripts(n);
    EXPECT_LT((grid[n] - Eigen::Vector3f(0.5f * i, 0.5f * j, 0)).norm(), 1e-6f);
  }
}

TEST(FlatGrid, RoundTripFromVolumeToMapAndBack) {
  const FlatSheet sheet = foldedSheet();
  Grid lattice;
  lattice.size = {70, 70, 40};
  lattice.origin = Point(-35, -35, 0);
  const auto grid = flatGrid(sheet);
  const auto coordinates = flatCoordinates(sheet, lattice);
  std::vector<double> errors;
  for (std::size_t n = 0; n < coordinates.size(); ++n) {
    if (!coordinates[n].allFinite()) continue;
    const auto [i, j, k] = lattice.subscripts(n);
    const auto back = pointAt(grid, coordinates[n]);
    if (back) errors.push_back((*back - lattice.toWorld(Vector(i, j, k))).norm());
  }
  ASSERT_GT(errors.size(), 3000U);
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.1);
  EXPECT_LT(errors[errors.size() * 99 / 100], 0.3);
}

TEST(FlatCoordinates, AreThoseOfASlab) {
  const TriangleMesh plane = geometry::makeRectangle(8, 8, 8, 8);
  FlatSheet sheet{plane.faces, plane.positions, plane.positions, plane.positions};
  sheet.outer.col(2).setConstant(4);
  Grid lattice;
  lattice.size = {10, 10, 7};
  lattice.origin = Point(-0.75, -0.75, -1);
  const auto coordinates = flatCoordinates(sheet, lattice);
  int known = 0;
  for (std::size_t n = 0; n < coordinates.size(); ++n) {
    const auto [i, j, k] = lattice.subscripts(n);
    const Point p = lattice.toWorld(Vector(i, j, k));
    const bool inside =
        p.x() > 0 && p.x() < 8 && p.y() > 0 && p.y() < 8 && p.z() >= 0 && p.z() <= 4;
    ASSERT_EQ(coordinates[n].allFinite(), inside) << p.transpose();
    if (!inside) continue;
    ++known;
    EXPECT_LT((coordinates[n].cast<double>() - Vector(p.x(), p.y(), p.z() / 4)).norm(), 1e-5);
  }
  EXPECT_EQ(known, 8 * 8 * 5);
}

TEST(Resampled, ReproducesALinearFunctionAndKnowsNothingBeyondTheVolume) {
  Grid lattice;
  lattice.size = {6, 5, 4};
  lattice.spacing = Vector(1, 2, 3);
  lattice.origin = Point(-2, 1, 0);
  Volume<float> volume(lattice);
  const auto f = [](const Point& p) { return 3 * p.x() - p.y() + 0.5 * p.z(); };
  for (std::size_t n = 0; n < volume.size(); ++n) {
    const auto [i, j, k] = lattice.subscripts(n);
    volume[n] = static_cast<float>(f(lattice.toWorld(Vector(i, j, k))));
  }
  Grid three;
  three.size = {3, 1, 1};
  Volume<Eigen::Vector3f> points(three, Eigen::Vector3f::Zero());
  points[0] = Eigen::Vector3f(0.3f, 4.1f, 5.7f);
  points[1] = Eigen::Vector3f(3, 9, 9);     // the last voxel
  points[2] = Eigen::Vector3f(3.1f, 9, 9);  // beyond it
  const auto values = resampled(volume, points);
  EXPECT_NEAR(values[0], f(points[0].cast<double>()), 1e-5);
  EXPECT_NEAR(values[1], f(points[1].cast<double>()), 1e-5);
  EXPECT_TRUE(std::isnan(values[2]));
}

TEST(FlatGrid, RefusesNonsense) {
  const TriangleMesh plane = geometry::makeRectangle(2, 2, 2, 2);
  const FlatSheet sheet{plane.faces, plane.positions, plane.positions, plane.positions};
  EXPECT_THROW((void)flatGrid(sheet, {0, 1}), InvalidInput);
  EXPECT_THROW((void)flatGrid(sheet, {0.5, 0}), InvalidInput);
  EXPECT_THROW((void)flatGrid(sheet, {1e-6, 1}), InvalidInput);
}

}  // namespace
}  // namespace explica::flattening
