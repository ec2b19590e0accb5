// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/Untangling.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace explica::collision {
namespace {

/// Two spheres of radius 10 that overlap by `depth`: banks that passed through each other.
TriangleMesh makeOverlappingSpheres(double depth) {
  return geometry::joined(geometry::makeIcosphere(4, 10.0),
                          geometry::makeIcosphere(4, 10.0, Point(20 - depth, 0.3, 0.2)));
}

/// A sphere some of whose vertices are thrown out of place: folds.
TriangleMesh makeCrumpledSphere(double amount) {
  TriangleMesh mesh = geometry::makeIcosphere(4, 10.0);
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (Eigen::Index v = 0; v < mesh.vertexCount(); v += 97) {
    mesh.positions.row(v) +=
        amount * Eigen::RowVector3d(normal(random), normal(random), normal(random));
  }
  return mesh;
}

void expectAccountIsTrue(const TriangleMesh& mesh, const Untangling& result) {
  EXPECT_EQ(result.before, geometry::findSelfIntersections(mesh));
  EXPECT_EQ(result.after, geometry::findSelfIntersections({result.positions, mesh.faces}));
  EXPECT_TRUE(std::includes(result.before.begin(), result.before.end(), result.after.begin(),
                            result.after.end()));
  double most = 0;
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
    const double move = (result.positions.row(v) - mesh.positions.row(v)).norm();
    EXPECT_EQ(move > 0, std::binary_search(result.moved.begin(), result.moved.end(), v));
    most = std::max(most, move);
  }
  EXPECT_EQ(result.moveMax, most);
}

TEST(Untangling, PartsBanksThatPassedThroughEachOther) {
  for (const double depth : {0.05, 0.4}) {
    const TriangleMesh mesh = makeOverlappingSpheres(depth);
    const Untangling result = untangle(mesh);
    expectAccountIsTrue(mesh, result);
    EXPECT_GT(result.before.size(), 0u);
    EXPECT_TRUE(result.after.empty()) << depth;
    EXPECT_GT(result.moveMax, 0.25 * depth);  // half each way if both give way alike
    EXPECT_LT(result.moveMax, 3 * depth + 0.3);
  }
}

TEST(Untangling, MovesNoFartherThanItMust) {
  const TriangleMesh mesh = geometry::joined(
      geometry::makeIcosphere(4, 10.0), geometry::makeIcosphere(4, 10.0, Point(19.8, 0.3, 0.2)));
  const Untangling result = untangle(mesh);
  ASSERT_TRUE(result.after.empty());
  TriangleMesh nearly = mesh;
  nearly.positions += 0.98 * (result.positions - mesh.positions);
  EXPECT_FALSE(geometry::findSelfIntersections(nearly).empty());
}

TEST(Untangling, AStopLeavesWhatWasMendedByThen) {
  // Two places far apart: the stop is wanted once the first is mended.
  const TriangleMesh one = geometry::joined(
      geometry::makeIcosphere(4, 10.0), geometry::makeIcosphere(4, 10.0, Point(19.8, 0.3, 0.2)));
  TriangleMesh other = one;
  other.positions.rowwise() += Eigen::RowVector3d(0, 0, 100);
  const TriangleMesh mesh = geometry::joined(one, other);
  int asked = 0;
  Monitor monitor;
  monitor.stopWanted = [&] { return ++asked > 1; };
  const Untangling result = untangle(mesh, {}, monitor);
  EXPECT_FALSE(result.after.empty());
  EXPECT_LT(result.after.size(), result.before.size());
  EXPECT_EQ(result.after, geometry::findSelfIntersections({result.positions, mesh.faces}));
}

TEST(Untangling, OpensFolds) {
  const TriangleMesh mesh = makeCrumpledSphere(1.2);
  const Untangling result = untangle(mesh);
  expectAccountIsTrue(mesh, result);
  EXPECT_GT(result.before.size(), 20u);
  EXPECT_TRUE(result.after.empty());
  EXPECT_LT(result.moved.size(), static_cast<std::size_t>(mesh.vertexCount()) / 2);
}

TEST(Untangling, LeavesASoundSurfaceAlone) {
  const TriangleMesh mesh = geometry::makeFoldedSphere(3);
  const Untangling result = untangle(mesh);
  EXPECT_TRUE(result.moved.empty());
  EXPECT_EQ(result.positions, mesh.positions);
}

TEST(Untangling, DoesNotTearLinkedRingsApart) {
  // A tube through a wall for good: no small move can part them, and none is claimed.
  const TriangleMesh mesh = geometry::joined(geometry::makeRectangle(20, 20, 20, 20), [] {
    TriangleMesh ring = geometry::makeTorus(60, 12, 8, 1.5);
    ring.positions.col(0).swap(ring.positions.col(2));
    ring.positions.rowwise() += Eigen::RowVector3d(10, 10, 0);
    return ring;
  }());
  const Untangling result = untangle(mesh);
  expectAccountIsTrue(mesh, result);
  EXPECT_FALSE(result.after.empty());
}

TEST(Untangling, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh mesh = makeCrumpledSphere(1.2);
  setThreadCount(1);
  const Untangling one = untangle(mesh);
  setThreadCount(4);
  const Untangling four = untangle(mesh);
  setThreadCount(0);
  EXPECT_EQ(one.positions, four.positions);
}

TEST(Untangling, RefusesFlagsOfAnotherSurface) {
  EXPECT_THROW((void)untangle(geometry::makeIcosphere(1), {.concerned = {true}}), InvalidInput);
}

}  // namespace
}  // namespace explica::collision
