// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/SelfIntersection.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace explica::geometry {
namespace {

TEST(SelfIntersection, SoundSurfacesHaveNone) {
  for (const TriangleMesh& mesh : {makeIcosphere(4), makeFoldedSphere(4, 1.0, 0.6, 9),
                                   makeTorus(60, 30, 2, 0.9), makeRectangle(20, 30, 1, 2)}) {
    EXPECT_TRUE(findSelfIntersections(mesh).empty());
  }
}

TEST(SelfIntersection, FatTorusMeetsItselfOnItsAxis) {
  EXPECT_FALSE(findSelfIntersections(makeTorus(60, 30, 1, 1.2)).empty());
}

TEST(SelfIntersection, PushedVertexIsSeenFromTheMomentItTouches) {
  const TriangleMesh sphere = makeIcosphere(3);
  Eigen::Index opposite = 0;
  (void)(sphere.positions * sphere.positions.row(0).transpose()).minCoeff(&opposite);
  for (const double overshoot : {-1e-12, 0.0, 1e-12, 0.1}) {
    TriangleMesh mesh = sphere;  // vertex 0 goes through the sphere to the other side
    mesh.positions.row(0) = (1 + overshoot) * sphere.positions.row(opposite);
    EXPECT_EQ(findSelfIntersections(mesh).empty(), overshoot < 0) << overshoot;
  }
}

TEST(SelfIntersection, NumberingAndScaleDoNotMatter) {
  const TriangleMesh mesh = makeTorus(40, 20, 1, 1.1);
  const auto pairs = findSelfIntersections(mesh);
  TriangleMesh scaled = mesh;
  scaled.positions *= std::ldexp(1.0, -20);
  EXPECT_EQ(findSelfIntersections(scaled), pairs);
  TriangleMesh reversed = mesh;
  reversed.faces = mesh.faces.colwise().reverse().eval();
  EXPECT_EQ(findSelfIntersections(reversed).size(), pairs.size());
}

TEST(SelfIntersection, ThreadsDoNotMatter) {
  const TriangleMesh mesh = makeTorus(40, 20, 1, 1.1);
  setThreadCount(1);
  const auto pairs = findSelfIntersections(mesh);
  setThreadCount(4);
  EXPECT_EQ(findSelfIntersections(mesh), pairs);
  setThreadCount(0);
}

TEST(SelfIntersection, MarkedFacesSelectTheirPairs) {
  const TriangleMesh mesh = makeTorus(40, 20, 1, 1.1);
  const auto pairs = findSelfIntersections(mesh);
  ASSERT_FALSE(pairs.empty());
  std::vector<bool> marked(static_cast<std::size_t>(mesh.faceCount()), false);
  marked[pairs[0][1]] = true;
  std::vector<FacePair> expected;
  for (const auto& pair : pairs) {
    if (marked[pair[0]] || marked[pair[1]]) expected.push_back(pair);
  }
  EXPECT_EQ(findSelfIntersections(mesh, marked), expected);
}

TEST(SelfIntersection, OfWhatDidNotMoveThePairsStay) {
  TriangleMesh mesh = makeTorus(40, 20, 1, 1.1);
  const auto before = findSelfIntersections(mesh);
  std::vector<bool> moved(static_cast<std::size_t>(mesh.faceCount()), false);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) moved[f] = moved[f] || mesh.corner(f, k).x() > 1;
  }
  ASSERT_TRUE(std::ranges::find(moved, false) != moved.end());
  mesh.positions.col(0) = mesh.positions.col(0).array().min(2 - mesh.positions.col(0).array());
  const auto after = findSelfIntersections(mesh);
  ASSERT_NE(after, before);
  EXPECT_EQ(findSelfIntersections(mesh, moved, before), after);
}

TEST(SelfIntersection, LookAfterLookFindsWhatOneThroughAllFacesDoes) {
  TriangleMesh mesh = makeTorus(40, 20, 1, 1.1);
  mesh.positions.col(2) *= 2.5;
  SelfIntersectionSearch search;
  std::size_t found = 0;
  // So many vertices go at each look, some of them again and again.
  for (const int step : {1, 700, 90, 90, 350, 3, 2, 40, 40, 40, 40, 1, 90}) {
    std::vector<bool> marked(static_cast<std::size_t>(mesh.faceCount()), false);
    const auto moves = [&](std::int32_t v) { return v % step == step / 2; };
    std::vector<std::int32_t> moved;
    for (std::int32_t f = 0; f < mesh.faceCount(); ++f) {
      marked[f] = moves(mesh.faces(f, 0)) || moves(mesh.faces(f, 1)) || moves(mesh.faces(f, 2));
      if (marked[f]) moved.push_back(f);
    }
    for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
      if (moves(v)) mesh.positions.row(v) *= v % 3 == 0 ? 0.7 : 1.2;
    }
    const auto expected = findSelfIntersections(mesh, marked);
    EXPECT_EQ(search.find(mesh, moved), expected) << step;
    found += expected.size();
  }
  EXPECT_GT(found, 1000U);
}

TEST(SelfIntersection, FoldedEdgeAndDuplicateFaceAreFound) {
  TriangleMesh mesh;
  mesh.positions.resize(4, 3);
  mesh.positions << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.5, 0.25, 0;
  mesh.faces.resize(2, 3);
  mesh.faces << 0, 1, 2, 1, 0, 3;
  EXPECT_EQ(findSelfIntersections(mesh).size(), 1u);
  mesh.positions(3, 1) = -0.25;
  EXPECT_TRUE(findSelfIntersections(mesh).empty());
  mesh.faces.row(1) << 2, 1, 0;
  EXPECT_EQ(findSelfIntersections(mesh).size(), 1u);
}

}  // namespace
}  // namespace explica::geometry
