// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/CrossingLength.h"

#include "Explica/Testing/TaylorRemainder.h"

#include <gtest/gtest.h>

namespace explica::collision {
namespace {

TriangleMesh meshOf(std::initializer_list<Point> points, std::initializer_list<int> corners) {
  TriangleMesh mesh;
  mesh.positions.resize(static_cast<Eigen::Index>(points.size()), 3);
  Eigen::Index v = 0;
  for (const Point& p : points) mesh.positions.row(v++) = p.transpose();
  mesh.faces.resize(static_cast<Eigen::Index>(corners.size() / 3), 3);
  Eigen::Index n = 0;
  for (const int c : corners) mesh.faces(n / 3, n % 3) = c, ++n;
  return mesh;
}

/// One face pierced by two edges of the other, each by an edge of the other, and from a common
/// vertex.
std::vector<TriangleMesh> crossings() {
  return {
      meshOf({{0, 0, 0}, {6, 0, 0.3}, {0, 6, -0.2}, {1, 1, -1}, {2, 2.2, -1.2}, {1.5, 1.2, 2}},
             {0, 1, 2, 3, 4, 5}),
      meshOf({{0, 0, 0}, {6, 0, 0.3}, {0, 6, -0.2}, {1, 1, -1}, {-2, 2.2, -1.2}, {-0.5, 1.2, 2}},
             {0, 1, 2, 3, 4, 5}),
      meshOf({{0, 0, 0}, {6, 0, 0.3}, {0, 6, -0.2}, {2, 1, -1}, {1, 2.2, 1.2}},
             {0, 1, 2, 0, 3, 4})};
}

TEST(CrossingLength, OfTwoPlatesIsTheirCommonSegment) {
  const TriangleMesh mesh = meshOf(
      {{-5, -5, 0}, {5, -5, 0}, {0, 5, 0}, {-1, 0, -1}, {3, 0, -1}, {1, 0, 1}}, {0, 1, 2, 3, 4, 5});
  const std::vector<geometry::FacePair> pairs = {{0, 1}};
  EXPECT_NEAR(crossingLength(mesh, pairs).value, 2, 1e-12);
  // Lifted by dz, the upper half of the triangle gets wider by 2 dz.
  double lift = 0;
  for (int v = 3; v < 6; ++v) lift += crossingLength(mesh, pairs).gradient(v, 2);
  EXPECT_NEAR(lift, 2, 1e-12);
}

TEST(CrossingLength, GradientPassesTheTaylorTest) {
  for (const TriangleMesh& mesh : crossings()) {
    const auto pairs = geometry::findSelfIntersections(mesh);
    ASSERT_EQ(pairs.size(), 1u);
    const auto value = [&](const Positions& x) {
      return crossingLength({x, mesh.faces}, pairs).value;
    };
    const CrossingLength at = crossingLength(mesh, pairs);
    ASSERT_GT(at.value, 0.1);
    EXPECT_NEAR(test::taylorSlope(value, mesh.positions, at.gradient, 0.01), 2, 0.1);
  }
}

}  // namespace
}  // namespace explica::collision
