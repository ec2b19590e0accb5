// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/Curve.h"

#include "Explica/Core/Errors.h"
#include "Explica/Testing/Curves.h"
#include "Polygon.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::planar {
namespace {

TEST(Curve, RegionMayRunPastTheLastVertex) {
  const Curve square = polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  const Region region = regionBetween(square, 3, 1);
  EXPECT_EQ(edgesOf(square, region), (std::vector<int>{3, 0}));
  EXPECT_EQ(verticesOf(square, region), (std::vector<int>{3, 0, 1}));
  EXPECT_DOUBLE_EQ(lengthOf(square, region), 2);
}

TEST(Curve, WholeClosedRegionCountsEachVertexOnce) {
  const Curve square = polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  EXPECT_EQ(verticesOf(square, wholeRegion(square)).size(), 4U);
  EXPECT_EQ(edgesOf(square, wholeRegion(square)).size(), 4U);
}

TEST(Curve, RegionOutOfRangeIsRefused) {
  const Curve square = polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  EXPECT_THROW((void)regionBetween(square, 0, 4), InvalidInput);
  EXPECT_THROW((void)regionBetween(square, 2, 2), InvalidInput);
  Curve chain = square;
  chain.closed = false;
  EXPECT_THROW((void)regionBetween(chain, 3, 1), InvalidInput);
}

TEST(Curve, WhatFacesAViewpointLiesBetweenTheTangentsFromIt) {
  Positions2 circle(360, 2);
  for (int v = 0; v < 360; ++v) circle.row(v) << std::cos(v * kPi / 180), std::sin(v * kPi / 180);
  // From twice the radius the tangents meet the circle 60 degrees to either side.
  for (const int towards : {0, 45, 90, 200, 330}) {
    const Point2 eye = 2 * circle.row(towards).transpose();
    const Region region = regionFacing({circle}, eye);
    EXPECT_EQ(region.firstEdge, (towards + 300) % 360) << towards;
    EXPECT_EQ(region.edgeCount, 120) << towards;
  }
  EXPECT_THROW((void)regionFacing({circle}, Point2(0.5, 0)), InvalidInput);
  EXPECT_THROW((void)regionFacing({circle, false}, Point2(2, 0)), InvalidInput);
}

TEST(Curve, AreaIsPositiveCounterClockwise) {
  EXPECT_DOUBLE_EQ(signedArea(polygon({{5, 5}, {7, 5}, {7, 8}, {5, 8}}).positions), 6);
  EXPECT_DOUBLE_EQ(signedArea(polygon({{5, 5}, {5, 8}, {7, 8}, {7, 5}}).positions), -6);
}

TEST(Curve, CrossingTouchingAndFoldedEdgesAreFound) {
  using Pairs = std::vector<std::array<int, 2>>;
  EXPECT_EQ(intersectingEdges(polygon({{0, 0}, {2, 2}, {2, 0}, {0, 2}})), (Pairs{{0, 2}}));
  // A vertex exactly on another edge.
  EXPECT_EQ(intersectingEdges(polygon({{0, 0}, {4, 0}, {4, 2}, {2, 0}, {0, 2}})),
            (Pairs{{0, 2}, {0, 3}}));
  // Two neighbours over each other.
  EXPECT_EQ(intersectingEdges(polygon({{0, 0}, {4, 0}, {2, 0}, {1, 3}})).front(),
            (std::array<int, 2>{0, 1}));
  EXPECT_TRUE(intersectingEdges(makeCircle(100, 3)).empty());
}

TEST(Curve, GapOfOneRoundingErrorIsNoCrossing) {
  const double above = std::nextafter(0.5, 1.0);
  const Curve near = polygon({{0, 0}, {1, 1}, {1, 2}, {0.5, above}, {0, 2}});
  EXPECT_TRUE(intersectingEdges(near).empty());
}

TEST(Curve, ScribblesAreRefusedBeforeTheirCrossingsFillMemory) {
  Curve scribble;
  constexpr int kVertices = 4501;  // of a star whose edges all cross each other
  scribble.positions.resize(kVertices, 2);
  for (int v = 0; v < kVertices; ++v) {
    const double angle = kPi * v * (kVertices - 1) / kVertices;
    scribble.positions.row(v) << std::cos(angle), std::sin(angle);
  }
  EXPECT_THROW(static_cast<void>(intersectingEdges(scribble)), InvalidInput);
}

TEST(Curve, UnusableCurvesAreRefused) {
  EXPECT_THROW(requireUsable(polygon({{0, 0}, {1, 0}})), InvalidInput);
  EXPECT_THROW(requireUsable(polygon({{0, 0}, {0, 0}, {1, 0}})), InvalidInput);
  EXPECT_THROW(requireUsable(polygon({{0, 0}, {kNaN, 0}, {1, 0}})), InvalidInput);
}

}  // namespace
}  // namespace explica::planar
