// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/Repair.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"

#include <gtest/gtest.h>

namespace explica::collision {
namespace {

/// Two spheres of 10 mm that overlap by 0.2 mm about x = 9.9: banks that passed through each other.
TriangleMesh crossed() {
  return geometry::joined(geometry::makeIcosphere(4, 10.0),
                          geometry::makeIcosphere(4, 10.0, Point(19.8, 0.3, 0.2)));
}

RepairOptions farthest(double move) {
  RepairOptions options;
  options.maxMove = move;
  return options;
}

bool sameBits(const TriangleMesh& a, const Positions& b, std::int32_t v) {
  return a.positions.row(v) == b.row(v);
}

TEST(Repair, PartsCrossingsAndLeavesTheRest) {
  const TriangleMesh mesh = crossed();
  const auto result = repairSurfaces(std::span(&mesh, 1), farthest(5));
  ASSERT_EQ(result.size(), 1U);
  EXPECT_GT(result[0].before.size(), 0U);
  EXPECT_EQ(result[0].after.size(), 0U);
  EXPECT_TRUE(geometry::findSelfIntersections({result[0].positions, mesh.faces}).empty());
  EXPECT_LT(result[0].moved.size(), 1000U);
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
    const bool moved = std::binary_search(result[0].moved.begin(), result[0].moved.end(), v);
    EXPECT_NE(sameBits(mesh, result[0].positions, v), moved);
  }
}

TEST(Repair, PutsBackWhatWouldGoTooFar) {
  const TriangleMesh mesh = crossed();
  const auto result = repairSurfaces(std::span(&mesh, 1), farthest(1e-6));
  EXPECT_EQ(result[0].after, result[0].before);
  EXPECT_EQ(result[0].positions, mesh.positions);
  EXPECT_GT(result[0].putBackFar, 0U);
  EXPECT_THROW(static_cast<void>(repairSurfaces(std::span(&mesh, 1), farthest(0))), InvalidInput);
}

std::size_t meetings(const TriangleMesh& a, const TriangleMesh& b) {
  const auto pairs = geometry::findSelfIntersections(geometry::joined(a, b));
  return static_cast<std::size_t>(
      std::count_if(pairs.begin(), pairs.end(), [&](const geometry::FacePair& pair) {
        return pair[0] < a.faceCount() && pair[1] >= a.faceCount();
      }));
}

/// A ball about both spheres of crossed(), and a small one at a place of its own.
TriangleMesh around(const Point& place, double radius) {
  return geometry::joined(geometry::makeIcosphere(4, 60.0),
                          geometry::makeIcosphere(4, radius, place));
}

TEST(Repair, NeverMakesSurfacesMeet) {
  // A small ball between the two walls, which are 0.2 mm apart there: the walls cannot part without
  // meeting it.  Elsewhere it is in nobody's way.
  const TriangleMesh mesh = crossed();
  for (const bool between : {true, false}) {
    const TriangleMesh other = around(between ? Point(9.9, 0.15, 0.1) : Point(9.9, 30, 0), 0.05);
    ASSERT_EQ(meetings(mesh, other), 0U);
    const std::vector<TriangleMesh> both = {mesh, other};
    const auto result = repairSurfaces(both, farthest(5));
    EXPECT_EQ(meetings({result[0].positions, mesh.faces}, {result[1].positions, mesh.faces}), 0U);
    EXPECT_EQ(result[0].after.empty(), !between);
    EXPECT_EQ(result[0].putBackOther > 0, between);
    EXPECT_EQ(result[1].positions, other.positions);
  }
}

TEST(Repair, TakesOnlySurfacesThatCorrespond) {
  const std::vector<TriangleMesh> pair = {geometry::makeIcosphere(2, 10.0),
                                          geometry::makeIcosphere(3, 12.0)};
  EXPECT_THROW(static_cast<void>(repairSurfaces(pair)), InvalidInput);
  EXPECT_THROW(static_cast<void>(repairSurfaces({})), InvalidInput);
}

}  // namespace
}  // namespace explica::collision
