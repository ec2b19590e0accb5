// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonCollision.h"

#include "Explica/Core/StopScope.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace explica::planar {
namespace {

/// A vertex (2) above an edge (0, 1), joined far away.
Curve vertexOverEdge(const Point2& vertex) {
  Curve curve;
  curve.closed = false;
  curve.positions.resize(5, 2);
  curve.positions << 0, 0, 1, 0, 50, 50, 20, 80, vertex.x(), vertex.y();
  return curve;
}

TEST(PolygonCollision, BarrierIsSmoothAndItsDerivativesAreRight) {
  const double range = 2;
  for (const double d : {0.01, 0.5, 1.3, 1.999}) {
    const double step = 1e-6 * d;
    const double slope =
        (barrier(d + step, range).value - barrier(d - step, range).value) / (2 * step);
    const double curvature =
        (barrier(d + step, range).slope - barrier(d - step, range).slope) / (2 * step);
    EXPECT_NEAR(barrier(d, range).slope, slope, 1e-6 * std::abs(slope) + 1e-8);
    EXPECT_NEAR(barrier(d, range).curvature, curvature, 1e-6 * std::abs(curvature) + 1e-8);
    EXPECT_GT(barrier(d, range).value, 0);
    EXPECT_LT(barrier(d, range).slope, 0);
  }
  EXPECT_EQ(barrier(2, range).value, 0);
  EXPECT_NEAR(barrier(2 - 1e-6, range).curvature, 0, 1e-4);
}

TEST(PolygonCollision, AStopIsHeardWherePairsAreSought) {
  const Curve curve = vertexOverEdge({0.3, 1});
  const std::vector<bool> moving(5, true);
  EXPECT_FALSE(nearbyPairs(curve, moving, edgeLengths(curve), 2, 2).empty());
  Monitor monitor;
  monitor.stopWanted = [] { return true; };
  const StopScope scope(&monitor);
  EXPECT_THROW((void)nearbyPairs(curve, moving, edgeLengths(curve), 2, 2), Interrupted);
}

TEST(PolygonCollision, HeadOnStepEndsJustBeforeTheContact) {
  const Curve curve = vertexOverEdge({0.3, 1});
  Positions2 target = curve.positions;
  target(4, 1) = -3;  // contact at a quarter of the way
  const std::vector<VertexEdgePair> pairs = {{4, 0, 0.1}};
  const double t = largestSafeStep(curve, target, pairs);
  EXPECT_LT(t, 0.25);
  EXPECT_GT(t, 0.12);  // half of the distance may be kept
}

TEST(PolygonCollision, CommonMotionIsFree) {
  const Curve curve = vertexOverEdge({0.3, 1e-3});
  Positions2 target = curve.positions;
  target.rowwise() += Eigen::RowVector2d(1000, -1000);
  EXPECT_EQ(largestSafeStep(curve, target, {{4, 0, 0.1}}), 1);
}

TEST(PolygonCollision, MissedEdgeDoesNotStopTheStep) {
  const Curve curve = vertexOverEdge({2.5, 1});
  Positions2 target = curve.positions;
  target(4, 1) = -1;
  EXPECT_EQ(largestSafeStep(curve, target, {{4, 0, 0.1}}), 1);
}

TEST(PolygonCollision, RandomStepsNeverReachTheFirstContact) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int stopped = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    Curve curve;
    curve.closed = false;
    curve.positions.resize(5, 2);
    for (int v = 0; v < 5; ++v) curve.positions.row(v) << uniform(random), uniform(random);
    Positions2 target = curve.positions;
    for (int v = 0; v < 5; ++v)
      target.row(v) += Eigen::RowVector2d(uniform(random), uniform(random));
    const std::vector<VertexEdgePair> pairs = {{4, 0, 0.1}};
    const double start = vertexEdgeDistance(curve, 4, 0).distance;
    const double t = largestSafeStep(curve, target, pairs);
    ASSERT_GE(t, 0);
    ASSERT_LE(t, 1);
    stopped += t < 1;
    // At every earlier time the pair is apart.
    for (int k = 0; k <= 50; ++k) {
      Curve at = curve;
      at.positions += t * k / 50 * (target - curve.positions);
      ASSERT_GE(vertexEdgeDistance(at, 4, 0).distance, 0.499 * start) << "trial " << trial;
    }
  }
  EXPECT_GT(stopped, 100);
}

TEST(PolygonCollision, NearbyPairsAreAllThatBruteForceFinds) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(0, 10);
  Curve curve;
  curve.positions.resize(40, 2);
  for (int v = 0; v < 40; ++v) curve.positions.row(v) << uniform(random), uniform(random);
  std::vector<bool> moving(40, false);
  for (int v = 5; v < 20; ++v) moving[v] = true;
  std::size_t expected = 0;
  for (int e = 0; e < 40; ++e) {
    for (int v = 0; v < 40; ++v) {
      if (v == e || v == curve.next(e)) continue;
      if (!moving[v] && !moving[e] && !moving[curve.next(e)]) continue;
      if (vertexEdgeDistance(curve, v, e).distance <= 2) ++expected;
    }
  }
  EXPECT_EQ(nearbyPairs(curve, moving, edgeLengths(curve), 0.5, 2).size(), expected);
}

TEST(PolygonCollision, NearbyPairsAreFoundWhateverTheReachAndTheSpread) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const double stretch : {1.0, 1e3, 1e9}) {
    for (const double reach : {1e-6, 0.3, 1e3}) {
      Curve curve;
      curve.positions.resize(50, 2);
      for (int v = 0; v < 50; ++v)
        curve.positions.row(v) << stretch * uniform(random), uniform(random);
      std::vector<std::array<int, 2>> expected;
      for (int e = 0; e < 50; ++e) {
        for (int v = 0; v < 50; ++v) {
          if (v == e || v == curve.next(e)) continue;
          if (vertexEdgeDistance(curve, v, e).distance <= reach) expected.push_back({v, e});
        }
      }
      std::vector<std::array<int, 2>> found;
      for (const VertexEdgePair& pair :
           nearbyPairs(curve, std::vector<bool>(50, true), edgeLengths(curve), 1, reach)) {
        found.push_back({pair.vertex, pair.edge});
      }
      EXPECT_EQ(found, expected) << stretch << " " << reach;  // in this order, on which sums hang
    }
  }
}

}  // namespace
}  // namespace explica::planar
