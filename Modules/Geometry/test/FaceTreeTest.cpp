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

/// The nearest of all faces, the first of those that are equally near.
ClosestPoint bruteForce(const TriangleMesh& mesh, const Point& query) {
  ClosestPoint best;
  for (std::int32_t f = 0; f < mesh.faceCount(); ++f) {
    const Point nearest =
        closestPointOnTriangle(query, mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2));
    const double squared = (nearest - query).squaredNorm();
    if (squared < best.squaredDistance) best = {nearest, f, squared};
  }
  return best;
}

TEST(FaceTree, GivesTheFirstOfEquallyNearFacesWhereverItLooksFirst) {
  const TriangleMesh mesh = makeIcosphere(2);
  const FaceTree tree(mesh);
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
    const Point beyond = 2 * mesh.positions.row(v).transpose();
    const ClosestPoint expected = bruteForce(mesh, beyond);
    EXPECT_EQ(tree.closestPoint(beyond).face, expected.face);
    for (std::int32_t near = v % 7; near < mesh.faceCount(); near += 7) {
      EXPECT_EQ(tree.closestPoint(beyond, near).face, expected.face);
    }
  }
}

TEST(FaceTree, ClosestPointEqualsBruteForceInAnyUnitAndPlace) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (const double unit : {1e-30, 1e-3, 1.0, 1e3, 1e30}) {
    for (const double place : {0.0, 1e4, -1e9}) {
      TriangleMesh mesh = makeFoldedSphere(2);
      mesh.positions.array() += place;
      mesh.positions *= unit;
      const FaceTree tree(mesh);
      for (const double away : {0.1, 1.0, 10.0, 1e6, 1e20}) {
        for (int n = 0; n < 20; ++n) {
          const Point way(normal(random), normal(random), normal(random));
          const Point query = unit * (Point::Constant(place) + away * way);
          const ClosestPoint found = tree.closestPoint(query), expected = bruteForce(mesh, query);
          EXPECT_EQ(found.squaredDistance, expected.squaredDistance) << unit << " " << place;
          EXPECT_EQ(found.face, expected.face) << unit << " " << place << " " << away;
        }
      }
    }
  }
}

TEST(FaceTree, FlatAndTinyMeshesAreNoSpecialCase) {
  TriangleMesh one;
  one.positions.resize(3, 3);
  one.positions << 1, 2, 3, 1, 2, 3, 1, 2, 3;
  one.faces.resize(1, 3);
  one.faces << 0, 1, 2;
  EXPECT_EQ(FaceTree(one).closestPoint(Point(1, 2, 5)).squaredDistance, 4);
  TriangleMesh flat = makeIcosphere(2);
  flat.positions.col(1).setZero();
  EXPECT_EQ(FaceTree(flat).closestPoint(Point(0.1, 3, 0.2)).squaredDistance,
            bruteForce(flat, Point(0.1, 3, 0.2)).squaredDistance);
  EXPECT_EQ(FaceTree(TriangleMesh()).closestPoint(Point(0, 0, 0)).face, -1);
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
