// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/LevelOfEnds.h"
#include "Explica/Geometry/Fixtures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::surface {
namespace {

constexpr double kInnerRadius = 12, kOuterRadius = 15;

Grid cubeWith(const Vector& spacing) {
  Grid grid;
  for (int a = 0; a < 3; ++a) grid.size[a] = static_cast<int>(40 / spacing[a]) + 1;
  grid.spacing = spacing;
  grid.direction << std::cos(0.3), -std::sin(0.3), 0, std::sin(0.3), std::cos(0.3), 0, 0, 0, 1;
  grid.origin = -grid.direction * Vector(0.5 * (grid.size[0] - 1) * spacing[0],
                                         0.5 * (grid.size[1] - 1) * spacing[1],
                                         0.5 * (grid.size[2] - 1) * spacing[2]);
  return grid;
}

/// Shares of a ball that are 0 or 1 but within a voxel of its surface.
LevelSet ballOf(const Grid& grid, double radius) {
  LevelSet level(grid);
  for (std::size_t v = 0; v < level.size(); ++v) {
    const auto s = grid.subscripts(v);
    const double inside = radius - grid.toWorld(Vector(s[0], s[1], s[2])).norm();
    level[v] = offZero(static_cast<float>(std::clamp(2 * inside, -1.0, 1.0)));
  }
  return level;
}

std::vector<Trajectory> radiiOf(const TriangleMesh& ball) {
  std::vector<Trajectory> paths;
  for (Eigen::Index v = 0; v < ball.vertexCount(); ++v) {
    const Point from = ball.positions.row(v);
    Trajectory path;
    path.points = {from, kOuterRadius / kInnerRadius * from};
    path.along = {0, static_cast<float>(kOuterRadius - kInnerRadius)};
    path.end = TrajectoryEnd::Outer;
    paths.push_back(path);
  }
  return paths;
}

/// Zero of a level along the ray through a point.
double radiusAt(const LevelSet& level, const Point& way) {
  double low = kInnerRadius, high = kOuterRadius + 3;
  for (int halving = 0; halving < 40; ++halving) {
    const double middle = 0.5 * (low + high);
    (sample(level, middle * way.normalized()).value > 0 ? low : high) = middle;
  }
  return low;
}

TEST(LevelOfEnds, DistanceIsKnownWhereSharesAreFull) {
  const LevelSet level = distanceLevelOf(ballOf(cubeWith(Vector::Constant(1)), kOuterRadius));
  for (const double inside : {-1.3, -0.5, 0.5, 1.3}) {
    // 1 is a distance of two voxels.
    const Point at(0, 0.6 * (kOuterRadius - inside), 0.8 * (kOuterRadius - inside));
    EXPECT_NEAR(sample(level, at).value, inside / 2, 0.06) << inside;
  }
}

TEST(LevelOfEnds, TheBorderGoesWithTheEnds) {
  const TriangleMesh ball = geometry::makeIcosphere(5, kInnerRadius);
  for (const Vector& spacing : {Vector(1, 1, 1), Vector(0.8, 0.8, 1.6)}) {
    const LevelSet distance = distanceLevelOf(ballOf(cubeWith(spacing), kOuterRadius));
    for (const double moved : {-1.5, -0.4, 0.0, 0.5}) {
      const LevelSet level = levelOfEnds(distance, radiiOf(ball), PathBorder::Outer,
                                         Eigen::VectorXd::Constant(ball.vertexCount(), moved));
      double sum = 0, squares = 0;
      int count = 0;
      for (Eigen::Index v = 0; v < ball.vertexCount(); v += 17, ++count) {
        const double off = radiusAt(level, ball.positions.row(v)) - kOuterRadius - moved;
        sum += off;
        squares += off * off;
      }
      const double voxel = spacing.maxCoeff();
      EXPECT_LT(std::abs(sum) / count, 0.06 * voxel) << moved << " on " << spacing.transpose();
      EXPECT_LT(std::sqrt(squares / count), 0.1 * voxel) << moved << " on " << spacing.transpose();
    }
  }
}

TEST(LevelOfEnds, WhatOneBankSaysIsNotSaidOfTheOther) {
  // Half a ball's ends move inward: the other half stays.
  const TriangleMesh ball = geometry::makeIcosphere(5, kInnerRadius);
  Eigen::VectorXd moved(ball.vertexCount());
  for (Eigen::Index v = 0; v < moved.size(); ++v) {
    moved[v] = ball.positions(v, 0) > 0 ? -0.8 : 0;
  }
  const LevelSet level =
      levelOfEnds(distanceLevelOf(ballOf(cubeWith(Vector::Constant(1)), kOuterRadius)),
                  radiiOf(ball), PathBorder::Outer, moved);
  for (Eigen::Index v = 0; v < moved.size(); v += 31) {
    if (std::abs(ball.positions(v, 0)) < 3) continue;
    EXPECT_NEAR(radiusAt(level, ball.positions.row(v)), kOuterRadius + moved[v], 0.12);
  }
}

}  // namespace
}  // namespace explica::surface
