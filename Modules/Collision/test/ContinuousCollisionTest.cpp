// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/ContinuousCollision.h"

#include "Samples.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <cmath>

namespace explica::collision {
namespace {

const FourPoints kTriangleAndVertex = {Point(0.2, 0.3, 1), Point(0, 0, 0), Point(1, 0, 0),
                                       Point(0, 1, 0)};

TEST(ContinuousCollision, HeadOnImpactTimeIsApproachedFromBelow) {
  FourPoints motion = {};
  for (auto& m : motion) m.setZero();
  motion[0] = Vector(0, 0, -4);  // meets the face at time 1/4
  const double t = safeTime(PairKind::VertexFace, kTriangleAndVertex, motion);
  EXPECT_LE(t, 0.25 * 0.9);  // a tenth of the distance is kept
  EXPECT_GT(t, 0.25 * 0.9 * 0.98);
  for (auto& m : motion) m += Vector(300, -200, 100);  // a common translation changes nothing
  EXPECT_NEAR(safeTime(PairKind::VertexFace, kTriangleAndVertex, motion), t, 1e-6);
}

TEST(ContinuousCollision, EdgesThatCrossAreStopped) {
  const FourPoints x = {Point(-1, 0, 0), Point(1, 0, 0), Point(0, -1, 1), Point(0, 1, 1)};
  FourPoints motion = {};
  for (auto& m : motion) m.setZero();
  motion[2] = motion[3] = Vector(0, 0, -2);
  const double t = safeTime(PairKind::EdgeEdge, x, motion);
  EXPECT_LT(t, 0.5);
  EXPECT_GT(t, 0.4);
}

TEST(ContinuousCollision, WhatPartsOrPassesIsFree) {
  FourPoints motion = {};
  for (auto& m : motion) m.setZero();
  motion[0] = Vector(0, 0, 5);
  EXPECT_EQ(safeTime(PairKind::VertexFace, kTriangleAndVertex, motion), 1);
  motion[0] = Vector(3, 0, 0);
  EXPECT_EQ(safeTime(PairKind::VertexFace, kTriangleAndVertex, motion), 1);
}

TEST(ContinuousCollision, ATouchingPairHasNoSafeTime) {
  FourPoints x = kTriangleAndVertex;
  x[0][2] = 0;
  FourPoints motion = {};
  for (auto& m : motion) m.setZero();
  motion[0] = Vector(0, 0, 1);
  EXPECT_EQ(safeTime(PairKind::VertexFace, x, motion), 0);
}

/// Sign of the volume of the four points: it changes when a vertex passes a face's plane or two
/// lines cross.
double volume(const FourPoints& x) {
  return (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0]);
}

/// Oracle: at each of many times the pair's distance; contact between samples shows as a distance
/// below what the motion can undo in half a sample.
TEST(ContinuousCollision, NoContactBeforeTheSafeTimeInRandomMotions) {
  std::mt19937 random(7);
  int stopped = 0;
  for (int n = 0; n < 4000; ++n) {
    const PairKind kind = n % 2 ? PairKind::VertexFace : PairKind::EdgeEdge;
    const FourPoints x = randomPoints(random), motion = randomPoints(random, 2);
    const double t = safeTime(kind, x, motion);
    const double start = std::sqrt(squaredDistance(kind, x));
    stopped += t < 1;
    for (int s = 0; s <= 50; ++s) {
      const double now = std::sqrt(squaredDistance(kind, moved(x, motion, t * s / 50)));
      ASSERT_GE(now, 0.0999 * start) << n;
    }
  }
  EXPECT_GT(stopped, 100);
}

/// Slivers, near-parallel edges, tiny gaps, far from the origin: exact side of the plane must never
/// change within the safe time.
TEST(ContinuousCollision, AdversarialNearDegeneratePairsNeverPassThroughEachOther) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int stopped = 0;
  for (int n = 0; n < 4000; ++n) {
    const double gap = std::pow(10.0, -6 + 5 * std::abs(uniform(random)));
    const double thin = std::pow(10.0, -6 + 6 * std::abs(uniform(random)));
    const Vector shift = 200 * Vector(uniform(random), uniform(random), uniform(random));
    FourPoints x, motion;
    PairKind kind;
    if (n % 2) {  // a vertex above the middle of a sliver
      kind = PairKind::VertexFace;
      x = {Point(0, thin / 3, gap), Point(-1, 0, 0), Point(1, 0, 0), Point(0, thin, 0)};
    } else {  // edges at a tiny angle
      kind = PairKind::EdgeEdge;
      x = {Point(-1, 0, 0), Point(1, 0, 0), Point(-1, -thin, gap), Point(1, thin, gap)};
    }
    for (int i = 0; i < 4; ++i) {
      x[i] += shift;
      motion[i] = 1e-3 * thin * Vector(uniform(random), uniform(random), 0);
      motion[i][2] = 1e-3 * gap * uniform(random);
    }
    const bool firstGroup = kind == PairKind::VertexFace;
    for (int i = 0; i < (firstGroup ? 1 : 2); ++i) motion[i][2] += (firstGroup ? -3 : 3) * gap;
    const double t = safeTime(kind, x, motion);
    stopped += t < 1;
    const double before = volume(x), after = volume(moved(x, motion, t));
    ASSERT_GT(before * after, 0) << "sample " << n << " gap " << gap << " thin " << thin;
    ASSERT_GT(t, 0) << "sample " << n << " gap " << gap << " thin " << thin;
  }
  EXPECT_EQ(stopped, 4000);
}

TEST(ContinuousCollision, PairsAlmostInContactThatOpenAreNotHeldUp) {
  // The gap is a millionth of the motion, and opens at a tenth of its speed.
  const FourPoints x = {Point(0.2, 0.2, 1e-7), Point(-1, -1, 0), Point(2, -1, 0), Point(-1, 2, 0)};
  const FourPoints motion = {Vector(0.5, 0.3, 0.1), Vector::Zero(), Vector::Zero(), Vector::Zero()};
  EXPECT_EQ(safeTime(PairKind::VertexFace, x, motion), 1);
}

TEST(ContinuousCollision, PairsAlmostInContactThatTurnAreNotHeldUp) {
  // x + t w x (x - c): a turn that is followed along straight lines brings nothing closer, but the
  // ends of the edges go two thousand gaps against each other along any direction that is kept.
  const FourPoints vertexFace = {Point(0.2, 0.3, 1e-4), Point(0, 0, 0), Point(1, 0, 0),
                                 Point(0, 1, 0)};
  const FourPoints edges = {Point(-1, 0, 0), Point(1, 0, 0), Point(0.3, -1, 1e-4),
                            Point(0.3, 1, 1e-4)};
  const Vector turn(0.2, -0.3, 0.1), shift(30, -20, 10);
  for (const PairKind kind : {PairKind::VertexFace, PairKind::EdgeEdge}) {
    FourPoints x = kind == PairKind::VertexFace ? vertexFace : edges, motion;
    for (int i = 0; i < 4; ++i) motion[i] = turn.cross(x[i]);
    for (auto& at : x) at += shift;
    EXPECT_EQ(safeTime(kind, x, motion), 1);
  }
}

TEST(ContinuousCollision, PairsNearerThanTheKeptDistanceHardlyComeNearer) {
  FourPoints x = kTriangleAndVertex;
  FourPoints motion = {};
  for (auto& m : motion) m.setZero();
  AdvanceOptions options;
  options.keptDistance = 0.01;
  for (const double start : {1.0, 0.02, 0.005}) {
    x[0][2] = start;
    motion[0] = Vector(0, 0, -4 * start);
    const double t = safeTime(PairKind::VertexFace, x, motion, 1, options);
    const double left = start * (1 - 4 * t),
                 kept = std::max(0.1 * start, std::min(0.01, 0.8 * start));
    EXPECT_GE(left, kept * (1 - 1e-12)) << start;
    EXPECT_LT(left, kept + 0.05 * start) << start;
  }
}

TEST(ContinuousCollision, PairsNeverPassTheLeastDistance) {
  FourPoints x = kTriangleAndVertex;
  FourPoints motion = {};
  for (auto& m : motion) m.setZero();
  AdvanceOptions options;
  options.leastDistance = 1e-5;
  double distance = 0.01;
  for (int step = 0; step < 2000; ++step) {
    x[0][2] = distance;
    motion[0] = Vector(0, 0, -4 * distance);
    distance *= 1 - 4 * safeTime(PairKind::VertexFace, x, motion, 1, options);
    ASSERT_GT(distance, options.leastDistance) << step;
  }
  EXPECT_LT(distance, 3.1 * options.leastDistance);
  x[0][2] = 1e-7;  // which starts nearer may come nearer still
  motion[0] = Vector(0, 0, -4e-7);
  EXPECT_GT(safeTime(PairKind::VertexFace, x, motion, 1, options), 0.2);
}

TEST(ContinuousCollision, WhatMovesAsOneIsSafeThoughItTouches) {
  const FourPoints x = {Point(0, 0, 0), Point(-1, -1, 0), Point(2, -1, 0), Point(-1, 2, 0)};
  const Vector along(0.3, 0.1, 0.7);
  EXPECT_EQ(safeTime(PairKind::VertexFace, x, {along, along, along, along}), 1);
  EXPECT_EQ(safeTime(PairKind::VertexFace, x, {Vector(0.3, 0.1, 0.8), along, along, along}), 0);
}

}  // namespace
}  // namespace explica::collision
