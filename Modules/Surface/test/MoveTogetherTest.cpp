// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/MoveTogether.h"

#include "../src/GuardedMesh.h"

#include "Explica/Geometry/SelfIntersection.h"

#include <gtest/gtest.h>

#include <numeric>

namespace explica::surface {
namespace {

/// Two square sheets of n x n vertices, one above the other.
TriangleMesh twoSheets(int n) {
  TriangleMesh mesh;
  mesh.positions.resize(2 * n * n, 3);
  mesh.faces.resize(4 * (n - 1) * (n - 1), 3);
  Eigen::Index row = 0;
  for (int sheet = 0; sheet < 2; ++sheet) {
    for (int v = 0; v < n * n; ++v) {
      mesh.positions.row(sheet * n * n + v) << v % n, v / n + 0.25 * sheet, sheet;
      if (v % n == n - 1 || v / n == n - 1) continue;
      const int a = sheet * n * n + v;
      mesh.faces.row(row++) << a, a + 1, a + n;
      mesh.faces.row(row++) << a + 1, a + n + 1, a + n;
    }
  }
  return mesh;
}

std::vector<std::int32_t> lowerSheet(int n) {
  std::vector<std::int32_t> vertices(n * n);
  std::iota(vertices.begin(), vertices.end(), 0);
  return vertices;
}

TEST(MoveTogether, GoesAllTheWayWhereNothingIsInTheWay) {
  TriangleMesh mesh = twoSheets(6);
  geometry::SelfIntersectionSearch search;
  const auto attempt =
      moveTogether(mesh, search, lowerSheet(6), 2,
                   [&](std::int32_t v, int) -> Point { return Point(v % 6, v / 6, 0.5); });
  for (const std::uint8_t a : attempt) EXPECT_EQ(a, 0);
  EXPECT_EQ(mesh.positions(0, 2), 0.5);
}

TEST(MoveTogether, WhatWouldMeetTakesTheNextAttemptOrStays) {
  constexpr int n = 12;
  TriangleMesh mesh = twoSheets(n);
  const TriangleMesh before = mesh;
  // One corner of the lower sheet would go through the upper one, all the way and half of it.
  geometry::SelfIntersectionSearch search;
  const auto attempt =
      moveTogether(mesh, search, lowerSheet(n), 2, [&](std::int32_t v, int way) -> Point {
        const int i = v % n, j = v / n;
        return Point(i, j, (i < 3 && j < 3 ? 4.0 : 0.5) / (way + 1));
      });
  EXPECT_TRUE(geometry::findSelfIntersections(mesh).empty());
  EXPECT_EQ(attempt[0], 2);
  EXPECT_EQ(mesh.positions.row(0), before.positions.row(0));
  EXPECT_EQ(attempt[n * n - 1], 0);
  EXPECT_EQ(mesh.positions(n * n - 1, 2), 0.5);
  EXPECT_EQ(mesh.positions.bottomRows(n * n), before.positions.bottomRows(n * n));
}

TEST(MoveTogether, AStepOfOneVertexAfterwardsSeesWhereAllAre) {
  constexpr int n = 12, upper = n * n + n * n / 2 + n / 2;
  const Point deep(n / 2, n / 2 + 0.25, 0.5);
  GuardedMesh mesh(twoSheets(n), 1);
  ASSERT_TRUE(mesh.move(upper, deep));
  ASSERT_TRUE(mesh.move(upper, twoSheets(n).positions.row(upper)));
  mesh.moveTogether(lowerSheet(n), 1,
                    [](std::int32_t v, int) { return Point(v % n, v / n, 0.75); });
  for (const std::int32_t v : lowerSheet(n)) ASSERT_EQ(mesh.at(v).z(), 0.75);
  EXPECT_FALSE(mesh.move(upper, deep));
}

}  // namespace
}  // namespace explica::surface
