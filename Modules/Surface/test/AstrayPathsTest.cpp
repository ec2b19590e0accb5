// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/AstrayPaths.h"

#include <gtest/gtest.h>

namespace explica::surface {
namespace {

/// A plane of n x n vertices 1 mm apart.
TriangleMesh plane(int n) {
  TriangleMesh mesh;
  mesh.positions.resize(n * n, 3);
  mesh.faces.resize(2 * (n - 1) * (n - 1), 3);
  for (int v = 0; v < n * n; ++v) mesh.positions.row(v) << v % n, v / n, 0;
  Eigen::Index f = 0;
  for (int v = 0; v + n < n * n; ++v) {
    if (v % n == n - 1) continue;
    mesh.faces.row(f++) << v, v + 1, v + n;
    mesh.faces.row(f++) << v + 1, v + n + 1, v + n;
  }
  return mesh;
}

Trajectory upTo(const Point& start, double length) {
  Trajectory path;
  path.end = TrajectoryEnd::Bank;
  for (const double at : {0.0, 0.5, 1.0}) {
    path.points.push_back(start + Vector(0, 0, at * length));
    path.along.push_back(static_cast<float>(at * length));
  }
  return path;
}

TEST(AstrayPaths, OneFarLongerThanAllAroundEndsAtTheirMedian) {
  const TriangleMesh white = plane(9);
  std::vector<Trajectory> paths;
  for (int v = 0; v < 81; ++v) paths.push_back(upTo(white.positions.row(v), 3));
  constexpr std::size_t kMiddle = 40;
  paths[kMiddle] = upTo(white.positions.row(kMiddle), 9);
  paths[kMiddle + 1] = upTo(white.positions.row(kMiddle + 1), 3.8);  // by less than a third
  paths[3] = Trajectory{{{white.positions.row(3)}, {0}}, TrajectoryEnd::NoRibbon};
  EXPECT_EQ(shortenAstray(white, 1, paths), 1);
  EXPECT_NEAR(paths[kMiddle].length(), 3, 1e-6);
  EXPECT_LT((paths[kMiddle].points.back() - Point(4, 4, 3)).norm(), 1e-6);
  EXPECT_EQ(paths[kMiddle].end, TrajectoryEnd::Astray);
  EXPECT_NEAR(paths[kMiddle + 1].length(), 3.8, 1e-6);
  EXPECT_EQ(paths[3].end, TrajectoryEnd::NoRibbon);
}

TEST(AstrayPaths, LessThanHalfAVoxelIsNoReason) {
  const TriangleMesh white = plane(9);
  std::vector<Trajectory> paths;
  for (int v = 0; v < 81; ++v) paths.push_back(upTo(white.positions.row(v), 1));
  paths[40] = upTo(white.positions.row(40), 1.45);
  EXPECT_EQ(shortenAstray(white, 1, paths), 0);
  EXPECT_EQ(shortenAstray(white, 0.8, paths), 1);
}

}  // namespace
}  // namespace explica::surface
