// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/Proximity.h"

#include "Samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace explica::collision {
namespace {

constexpr std::array kKinds = {PairKind::VertexFace, PairKind::EdgeEdge};

/// Smallest squared distance over a fine lattice of both features: an upper bound of the minimum.
double sampledSquaredDistance(PairKind kind, const FourPoints& x, int n) {
  double best = kInfinity;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j) {
      const double s = static_cast<double>(i) / n, t = static_cast<double>(j) / n;
      if (kind == PairKind::EdgeEdge) {
        best =
            std::min(best, ((1 - s) * x[0] + s * x[1] - (1 - t) * x[2] - t * x[3]).squaredNorm());
      } else if (s + t <= 1) {
        best = std::min(best, (x[0] - (1 - s - t) * x[1] - s * x[2] - t * x[3]).squaredNorm());
      }
    }
  }
  return best;
}

TEST(Proximity, IsTheSmallestOfSampledDistances) {
  std::mt19937 random(1);
  for (const PairKind kind : kKinds) {
    for (int n = 0; n < 300; ++n) {
      const FourPoints x = randomPoints(random);
      const double exact = std::sqrt(squaredDistance(kind, x));
      const double sampled = std::sqrt(sampledSquaredDistance(kind, x, 80));
      EXPECT_LE(exact, sampled + 1e-12);
      EXPECT_GE(exact, sampled - 4.0 / 80);  // no sample is farther than a cell from the minimum
    }
  }
}

TEST(Proximity, WeightsGiveTheDifference) {
  std::mt19937 random(2);
  for (const PairKind kind : kKinds) {
    for (int n = 0; n < 100; ++n) {
      const FourPoints x = randomPoints(random);
      const Proximity p = findProximity(kind, x);
      Vector difference = Vector::Zero();
      for (int i = 0; i < 4; ++i) difference += p.weights[i] * x[i];
      EXPECT_NEAR((difference - p.difference).norm(), 0, 1e-14);
      EXPECT_NEAR(p.weights[0] + p.weights[1] + p.weights[2] + p.weights[3], 0, 1e-14);
    }
  }
}

TEST(Proximity, DegenerateFeaturesActAsWhatTheyAre) {
  const Point o(0, 0, 0);
  EXPECT_DOUBLE_EQ(squaredDistance(PairKind::VertexFace, {Point(0, 0, 2), o, o, o}), 4);
  EXPECT_DOUBLE_EQ(
      squaredDistance(PairKind::VertexFace, {Point(1, 0, 2), o, Point(1, 0, 0), Point(3, 0, 0)}),
      4);
  EXPECT_DOUBLE_EQ(squaredDistance(PairKind::EdgeEdge, {o, o, Point(0, 3, 0), Point(0, 3, 0)}), 9);
  EXPECT_DOUBLE_EQ(
      squaredDistance(PairKind::EdgeEdge, {o, Point(1, 0, 0), Point(0.5, 2, 0), Point(4, 2, 0)}),
      4);
}

/// What a Taylor expansion leaves is the step times what the gradient changes on it, at most.
TEST(Proximity, GradientPassesTheTaylorTest) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  constexpr double h = 1e-5;
  for (const PairKind kind : kKinds) {
    for (int n = 0; n < 400; ++n) {
      const FourPoints x = randomPoints(random);
      const Proximity p = findProximity(kind, x);
      const Vector12 gradient = squaredDistanceGradient(p);
      Vector12 direction;
      for (int i = 0; i < 12; ++i) direction[i] = uniform(random);
      const Proximity next = findProximity(kind, moved(x, direction, h));
      const double change = (squaredDistanceGradient(next) - gradient).norm();
      EXPECT_LE(std::abs(next.squaredDistance - p.squaredDistance - h * gradient.dot(direction)),
                h * change * direction.norm() + 1e-14);
      EXPECT_LE(change, 0.01 * (1 + gradient.norm())) << "the bound tells something";
    }
  }
}

TEST(Proximity, GradientIsExactNextToCaseBorders) {
  // A vertex above the edge of a face, 1e-9 to either side: the gradient must not jump.
  for (const double side : {-1e-9, 1e-9}) {
    const FourPoints x = {Point(0.5, side, 1), Point(0, 0, 0), Point(1, 0, 0), Point(0, 1, 0)};
    const Vector12 g = squaredDistanceGradient(findProximity(PairKind::VertexFace, x));
    EXPECT_NEAR(g[2], 2, 1e-8);
    EXPECT_NEAR(g[5] + g[8] + g[11], -2, 1e-8);
  }
}

TEST(Proximity, BoundStaysBelowTheTrueDistanceOfNearlyParallelEdges) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int n = 0; n < 2000; ++n) {
    // Segments in planes z = 0 and z = gap that cross in projection: their distance is the gap.
    const double angle = std::pow(10, -8 + 7 * std::abs(uniform(random)));
    const double gap = std::pow(10, -9 + 8 * std::abs(uniform(random)));
    const Vector u(1, 0, 0), v(std::cos(angle), std::sin(angle), 0);
    const FourPoints x = {Point(-u), Point(u), Point(-v + gap * Vector::UnitZ()),
                          Point(v + gap * Vector::UnitZ())};
    EXPECT_LE(distanceBound(PairKind::EdgeEdge, x), gap * (1 + 1e-12)) << angle << " " << gap;
    if (gap > 1e-6) {
      EXPECT_GT(distanceBound(PairKind::EdgeEdge, x), 0.9 * gap) << angle;
    }
  }
}

}  // namespace
}  // namespace explica::collision
