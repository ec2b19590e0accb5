// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/TriangleIntersection.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::geometry {
namespace {

const Triangle kFloor = {Point(0, 0, 0), Point(4, 0, 0), Point(0, 4, 0)};

TEST(TrianglesIntersect, CrossingAndApart) {
  EXPECT_TRUE(trianglesIntersect(kFloor, {Point(1, 1, -1), Point(1, 1, 1), Point(5, 5, 1)}));
  EXPECT_FALSE(trianglesIntersect(kFloor, {Point(1, 1, 0.5), Point(1, 2, 1), Point(2, 1, 1)}));
  // Crosses the plane beside the triangle.
  EXPECT_FALSE(trianglesIntersect(kFloor, {Point(3, 3, -1), Point(3, 3, 1), Point(5, 5, 1)}));
}

TEST(TrianglesIntersect, TouchingCountsAndATinyGapDoesNot) {
  const auto above = [](double z) {
    return Triangle{Point(1, 1, z), Point(1, 2, 3), Point(2, 1, 3)};
  };
  EXPECT_TRUE(trianglesIntersect(kFloor, above(0)));
  EXPECT_FALSE(trianglesIntersect(kFloor, above(std::ldexp(1.0, -60))));
}

TEST(TrianglesIntersect, CoplanarCases) {
  EXPECT_TRUE(trianglesIntersect(kFloor, {Point(1, 1, 0), Point(1.5, 1, 0), Point(1, 1.5, 0)}));
  EXPECT_TRUE(trianglesIntersect(kFloor, {Point(3, -1, 0), Point(5, 3, 0), Point(3, 5, 0)}));
  EXPECT_FALSE(trianglesIntersect(kFloor, {Point(3, 3, 0), Point(5, 3, 0), Point(3, 5, 0)}));
}

TEST(TrianglesIntersect, DegenerateTrianglesCountAsSegments) {
  EXPECT_TRUE(trianglesIntersect(kFloor, {Point(1, 1, -1), Point(1, 1, 0.5), Point(1, 1, 2)}));
  EXPECT_FALSE(trianglesIntersect(kFloor, {Point(1, 1, 1), Point(1, 1, 1.5), Point(1, 1, 2)}));
  EXPECT_TRUE(trianglesIntersect({Point(0, 0, 0), Point(1, 0, 0), Point(2, 0, 0)},
                                 {Point(1, -1, 0), Point(1, 1, 0), Point(1, 3, 0)}));
  EXPECT_FALSE(trianglesIntersect({Point(0, 0, 0), Point(1, 0, 0), Point(2, 0, 0)},
                                  {Point(3, 0, 0), Point(4, 0, 0), Point(5, 0, 0)}));
}

TEST(TrianglesSharingVertex, OnlyTheCommonVertexIsAllowed) {
  const Point p(0, 0, 0), a(4, 0, 0), b(0, 4, 0);
  EXPECT_FALSE(trianglesSharingVertexIntersect(p, a, b, Point(-1, 0, 1), Point(0, -1, 1)));
  EXPECT_FALSE(trianglesSharingVertexIntersect(p, a, b, Point(1, 1, 1), Point(2, 1, 1)));
  EXPECT_TRUE(trianglesSharingVertexIntersect(p, a, b, Point(1, 1, 1), Point(1, 1, -1)));
  // Coplanar: beside each other, and overlapping.
  EXPECT_FALSE(trianglesSharingVertexIntersect(p, a, b, Point(-4, 0, 0), Point(0, -4, 0)));
  EXPECT_TRUE(trianglesSharingVertexIntersect(p, a, b, Point(1, 1, 0), Point(-1, 3, 0)));
}

TEST(TrianglesSharingEdge, OnlyAFoldOntoItselfIntersects) {
  const Point p(0, 0, 0), q(1, 0, 0), a(0, 1, 0);
  EXPECT_FALSE(trianglesSharingEdgeIntersect(p, q, a, Point(0, -1, 0)));
  EXPECT_TRUE(trianglesSharingEdgeIntersect(p, q, a, Point(0.5, 2, 0)));
  EXPECT_FALSE(trianglesSharingEdgeIntersect(p, q, a, Point(0.5, 2, 1e-60)));
}

}  // namespace
}  // namespace explica::geometry
