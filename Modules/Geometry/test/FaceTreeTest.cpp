// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/FaceTree.h"

#include "Explica/Geometry/Fixtures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace explica::geometry {
namespace {

std::vector<std::array<std::int32_t, 2>> allPairs(const std::vector<Box>& boxes) {
  std::vector<std::array<std::int32_t, 2>> pairs;
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(boxes.size()); ++i) {
    for (std::int32_t j = i + 1; j < static_cast<std::int32_t>(boxes.size()); ++j) {
      if (boxes[i].intersects(boxes[j])) pairs.push_back({i, j});
    }
  }
  return pairs;
}

TEST(BoxTree, FindsTheBruteForcePairs) {
  const auto boxes = faceBoxes(makeFoldedSphere(3), 0.02);
  EXPECT_EQ(BoxTree(boxes).overlappingPairs(), allPairs(boxes));
}

TEST(BoxTree, RefitFindsThePairsOfTheNewBoxes) {
  const TriangleMesh sphere = makeIcosphere(3);
  BoxTree tree(faceBoxes(sphere));
  TriangleMesh flat = sphere;
  flat.positions.col(2) *= 0.01;
  tree.refit(faceBoxes(flat));
  EXPECT_EQ(tree.overlappingPairs(), allPairs(faceBoxes(flat)));
}

TEST(BoxTree, ManyEqualBoxesAreNoSpecialCase) {
  const std::vector<Box> boxes(100, Box(Point(0, 0, 0), Point(1, 1, 1)));
  EXPECT_EQ(BoxTree(boxes).overlappingPairs().size(), 4950u);
}

TEST(BoxTree, EmptyTreeHasNoPairs) {
  EXPECT_TRUE(BoxTree(std::vector<Box>{}).overlappingPairs().empty());
}

TEST(FaceTree, ClosestPointEqualsBruteForce) {
  const TriangleMesh mesh = makeFoldedSphere(3);
  const FaceTree tree(mesh);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.5, 1.5);
  for (int n = 0; n < 500; ++n) {
    const Point query(uniform(random), uniform(random), uniform(random));
    double best = kInfinity;
    for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
      const Point nearest =
          closestPointOnTriangle(query, mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2));
      best = std::min(best, (nearest - query).squaredNorm());
    }
    EXPECT_EQ(tree.closestPoint(query).squaredDistance, best);
  }
}

TEST(ClosestPointOnTriangle, BeatsADenseSampleOfTheTriangle) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  const auto point = [&] { return Point(normal(random), normal(random), normal(random)); };
  for (int n = 0; n < 300; ++n) {
    const Point q = point(), a = point(), b = point(), c = point();
    const double distance = (closestPointOnTriangle(q, a, b, c) - q).norm();
    double sampled = kInfinity;
    constexpr int kSteps = 60;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; j <= kSteps - i; ++j) {
        const double s = double(i) / kSteps, t = double(j) / kSteps;
        sampled = std::min(sampled, (a + s * (b - a) + t * (c - a) - q).norm());
      }
    }
    const double spacing = std::max((b - a).norm(), (c - a).norm()) / kSteps;
    EXPECT_LE(distance, sampled + 1e-12);
    EXPECT_GE(distance, sampled - spacing);
  }
}

}  // namespace
}  // namespace explica::geometry
