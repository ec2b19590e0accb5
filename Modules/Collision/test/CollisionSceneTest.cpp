// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/CollisionScene.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/Testing/Meshes.h"
#include "Samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

namespace explica::collision {
namespace {

struct Setting {
  TriangleMesh mesh;
  std::vector<bool> moves;
  Positions motion;
};

/// A folded sphere whose upper part moves at random.
Setting foldedCap(double speed) {
  Setting s;
  s.mesh = geometry::makeFoldedSphere(3, 10, 0.3, 6);
  s.moves.resize(static_cast<std::size_t>(s.mesh.vertexCount()));
  s.motion = Positions::Zero(s.mesh.vertexCount(), 3);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-speed, speed);
  for (Eigen::Index v = 0; v < s.mesh.vertexCount(); ++v) {
    s.moves[v] = s.mesh.positions(v, 2) > 3;
    if (s.moves[v]) s.motion.row(v) << uniform(random), uniform(random), uniform(random);
  }
  return s;
}

/// Every pair with a moving vertex and without a common one that the path sampled finely brings
/// within reach.
std::set<Pair> pairsByBruteForce(const Setting& s, const CollisionScene& scene, double reach) {
  std::set<Pair> near;
  // Whose first and last vertex are farther apart than this never meet.
  double far = reach + 2 * s.motion.rowwise().norm().maxCoeff();
  double longest = 0;
  for (Eigen::Index e = 0; e < scene.edges().rows(); ++e) {
    const auto ends = scene.edges().row(e);
    longest =
        std::max(longest, (s.mesh.positions.row(ends[0]) - s.mesh.positions.row(ends[1])).norm());
  }
  far += 2 * longest;
  const auto consider = [&](const Pair& pair) {
    const auto v = scene.vertices(pair);
    if ((s.mesh.positions.row(v[0]) - s.mesh.positions.row(v[3])).squaredNorm() > far * far) return;
    if (std::none_of(v.begin(), v.end(), [&](std::int32_t i) { return s.moves[i]; })) return;
    std::set<std::int32_t> distinct(v.begin(), v.end());
    if (distinct.size() < 4) return;
    const FourPoints x = scene.points(pair, s.mesh.positions), m = scene.points(pair, s.motion);
    for (int k = 0; k <= 8; ++k) {
      FourPoints y = x;
      for (int i = 0; i < 4; ++i) y[i] += k / 8.0 * m[i];
      if (squaredDistance(pair.kind, y) < reach * reach) {
        near.insert(pair);
        return;
      }
    }
  };
  for (std::int32_t f = 0; f < s.mesh.faceCount(); ++f) {
    for (std::int32_t v = 0; v < s.mesh.vertexCount(); ++v) consider({PairKind::VertexFace, v, f});
  }
  const auto edges = static_cast<std::int32_t>(scene.edges().rows());
  for (std::int32_t e = 0; e < edges; ++e) {
    for (std::int32_t f = e + 1; f < edges; ++f) consider({PairKind::EdgeEdge, e, f});
  }
  return near;
}

TEST(CollisionScene, FindsAllPairsOfBruteForceIncludingTheRingToTheSurroundings) {
  const Setting s = foldedCap(0.5);
  const CollisionScene scene(s.mesh, s.moves);
  const auto pairs = scene.findPairs(s.mesh.positions, s.motion, 1.0);
  const std::set<Pair> found(pairs.begin(), pairs.end());
  EXPECT_EQ(found.size(), pairs.size());
  const auto expected = pairsByBruteForce(s, scene, 1.0);
  EXPECT_GT(expected.size(), 500u);
  for (const Pair& pair : expected) EXPECT_TRUE(found.count(pair));
}

TEST(CollisionScene, FindsAllPairsOfWhatMovesTogetherOverFar) {
  Setting s = foldedCap(0.2);
  for (Eigen::Index v = 0; v < s.mesh.vertexCount(); ++v) {
    if (s.moves[v]) s.motion(v, 2) += 6;
  }
  const CollisionScene scene(s.mesh, s.moves);
  const auto pairs = scene.findPairs(s.mesh.positions, s.motion, 1.0);
  const std::set<Pair> found(pairs.begin(), pairs.end());
  const auto expected = pairsByBruteForce(s, scene, 1.0);
  EXPECT_GT(expected.size(), 500u);
  for (const Pair& pair : expected) EXPECT_TRUE(found.count(pair));
}

TEST(CollisionScene, WhatMeetingsKnowHoldsAllTheWay) {
  Setting s = foldedCap(0.05);
  const CollisionScene scene(s.mesh, s.moves);
  for (const std::int32_t v : scene.movingVertices())
    s.motion.row(v) += 2 * s.mesh.positions.row(v);
  const auto meetings = scene.findMeetings(s.mesh.positions, s.motion, 2);
  ASSERT_GT(meetings.size(), 300u);
  std::size_t opening = 0;
  for (const Meeting& m : meetings) {
    const FourPoints x = scene.points(m.pair, s.mesh.positions),
                     by = scene.points(m.pair, s.motion);
    EXPECT_NEAR(m.separation, std::sqrt(squaredDistance(m.pair.kind, x)), 1e-12);
    EXPECT_LE(m.separation - std::max(0.0, m.closing), 2 + 1e-9);
    opening += m.closing <= 0;
    for (int k = 0; k <= 10; ++k) {
      const double t = k / 10.0;
      const double distance = std::sqrt(squaredDistance(m.pair.kind, moved(x, by, t)));
      ASSERT_GE(distance, m.separation - std::max(0.0, t * m.closing) - 1e-12);
    }
  }
  EXPECT_GT(opening, 100u);
}

TEST(CollisionScene, WhatIsFoundHangsOnNothingButTheArguments) {
  // Another scene with the same moving part: other trees, as after a restart elsewhere on the way.
  const Setting s = foldedCap(0.5);
  const CollisionScene scene(s.mesh, s.moves);
  TriangleMesh elsewhere = s.mesh;
  for (const std::int32_t v : scene.movingVertices()) elsewhere.positions.row(v) *= 1.3;
  const CollisionScene restarted(elsewhere, s.moves);
  EXPECT_EQ(scene.findPairs(s.mesh.positions, s.motion, 0.5),
            restarted.findPairs(s.mesh.positions, s.motion, 0.5));
  const auto pairs = scene.findPairs(s.mesh.positions, s.motion, 0.5);
  EXPECT_TRUE(std::is_sorted(pairs.begin(), pairs.end()));
}

TEST(CollisionScene, WhatIsUpdatedIsWhatANewSearchFinds) {
  Setting s = foldedCap(0.5);
  const CollisionScene scene(s.mesh, s.moves);
  auto meetings = scene.findMeetings(s.mesh.positions, s.motion, 0.8);
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto& moving = scene.movingVertices();
  for (const std::size_t every : {97, 13, 2}) {
    std::vector<std::int32_t> changed;
    for (std::size_t n = every / 2; n < moving.size(); n += every) {
      changed.push_back(moving[n]);
      s.motion.row(moving[n]) << uniform(random), uniform(random), uniform(random);
    }
    meetings = scene.updateMeetings(meetings, s.mesh.positions, s.motion, 0.8, changed);
    const auto anew = scene.findMeetings(s.mesh.positions, s.motion, 0.8);
    ASSERT_EQ(meetings.size(), anew.size());
    for (std::size_t n = 0; n < anew.size(); ++n) {
      EXPECT_EQ(meetings[n].pair, anew[n].pair);
      EXPECT_EQ(meetings[n].separation, anew[n].separation);
      EXPECT_EQ(meetings[n].closing, anew[n].closing);
    }
  }
}

TEST(CollisionScene, MeetingsGiveTheSafeStepOfTheirPairs) {
  Setting s = foldedCap(2);
  const CollisionScene scene(s.mesh, s.moves);
  const auto meetings = scene.findMeetings(s.mesh.positions, s.motion, 0.1);
  double byPairs = 1;
  for (const Pair& pair : scene.findPairs(s.mesh.positions, s.motion, 0.1)) {
    byPairs = std::min(byPairs, safeTime(pair.kind, scene.points(pair, s.mesh.positions),
                                         scene.points(pair, s.motion), byPairs));
  }
  EXPECT_LT(byPairs, 1);
  EXPECT_GT(byPairs, 0);
  EXPECT_NEAR(largestSafeStep(scene, meetings, s.mesh.positions, s.motion), byPairs, 1e-12);
}

TEST(CollisionScene, RingFacesMoveThoughSomeOfTheirVerticesDoNot) {
  TriangleMesh mesh = geometry::makeRectangle(4, 4, 4, 4);
  std::vector<bool> moves(static_cast<std::size_t>(mesh.vertexCount()), false);
  moves[12] = true;  // the middle
  const CollisionScene scene(mesh, moves);
  EXPECT_EQ(scene.movingVertices().size(), 1u);
  EXPECT_EQ(scene.movingFaces().size(), 6u);
}

TEST(CollisionScene, ThreadCountDoesNotChangeThePairs) {
  const Setting s = foldedCap(0.5);
  const CollisionScene scene(s.mesh, s.moves);
  setThreadCount(1);
  const auto one = scene.findPairs(s.mesh.positions, s.motion, 0.3);
  setThreadCount(4);
  const auto four = scene.findPairs(s.mesh.positions, s.motion, 0.3);
  setThreadCount(0);
  EXPECT_EQ(one, four);
}

TEST(CollisionScene, SafeStepsNeverIntersectThoughTheFullStepWould) {
  Setting s = foldedCap(4);
  const CollisionScene scene(s.mesh, s.moves);
  ASSERT_TRUE(geometry::findSelfIntersections(s.mesh).empty());
  TriangleMesh full = s.mesh;
  full.positions += s.motion;
  ASSERT_FALSE(geometry::findSelfIntersections(full).empty());
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-4, 4);
  for (int step = 0; step < 20; ++step) {
    for (const std::int32_t v : scene.movingVertices()) {
      s.motion.row(v) << uniform(random), uniform(random), uniform(random);
    }
    const auto meetings = scene.findMeetings(s.mesh.positions, s.motion, 0);
    s.mesh.positions += largestSafeStep(scene, meetings, s.mesh.positions, s.motion) * s.motion;
    ASSERT_TRUE(geometry::findSelfIntersections(s.mesh).empty()) << step;
  }
}

}  // namespace
}  // namespace explica::collision
