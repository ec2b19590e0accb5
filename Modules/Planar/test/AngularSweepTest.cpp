// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/AngularSweep.h"

#include "Explica/Geometry/Predicates.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Testing/Curves.h"
#include "Polygon.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::planar {
namespace {

/// Samples each edge and follows the ray to the viewpoint.
double sampledFraction(const Curve& curve, const Region& region, const Point2& viewpoint,
                       int samples) {
  const auto crosses = [&](const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
    return geometry::orientation(a, b, c) * geometry::orientation(a, b, d) < 0 &&
           geometry::orientation(c, d, a) * geometry::orientation(c, d, b) < 0;
  };
  double seen = 0;
  double total = 0;
  for (int e : edgesOf(curve, region)) {
    const Point2 a = curve.point(e);
    const Point2 b = curve.point(curve.next(e));
    const double length = (b - a).norm();
    for (int k = 0; k < samples; ++k) {
      const Point2 x = a + (k + 0.5) / samples * (b - a);
      bool visible = geometry::orientation(a, b, viewpoint) < 0;
      for (int f = 0; f < curve.edgeCount() && visible; ++f) {
        if (f != e) visible = !crosses(x, viewpoint, curve.point(f), curve.point(curve.next(f)));
      }
      total += length;
      if (visible) seen += length;
    }
  }
  return seen / total;
}

TEST(AngularSweep, HalfOfACircleIsSeenFromFar) {
  const Curve circle = makeCircle(720, 1);
  EXPECT_NEAR(visiblePart(circle, wholeRegion(circle), {0, 1e6}).fraction, 0.5, 1e-5);
  // From distance D the seen arc spans 2 acos(R/D); chords that straddle its ends are front or not.
  EXPECT_NEAR(visiblePart(circle, wholeRegion(circle), {2, 0}).fraction, std::acos(0.5) / kPi,
              2.0 / 720);
}

TEST(AngularSweep, SquareShowsWhatGeometrySays) {
  const Curve square = polygon({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  const VisiblePart above = visiblePart(square, wholeRegion(square), {0.5, 3});
  EXPECT_DOUBLE_EQ(above.edgeSeen[2], 1);
  EXPECT_DOUBLE_EQ(above.edgeSeen[0] + above.edgeSeen[1] + above.edgeSeen[3], 0);
  const VisiblePart corner = visiblePart(square, wholeRegion(square), {3, 4});
  EXPECT_NEAR(corner.fraction, 0.5, 1e-14);
}

TEST(AngularSweep, NotchHidesTheExactShareOfItsFloor) {
  // A slot 1 wide and 2 deep in a block; from (1.5, 8) the left rim hides nothing of the floor's
  // right part: the ray over rim (2, 2) meets the floor y = 0 at x = 2 + 2 * 0.5 / 6.
  const Curve block = polygon({{0, -1}, {6, -1}, {6, 2}, {3, 2}, {3, 0}, {2, 0}, {2, 2}, {0, 2}});
  const VisiblePart part = visiblePart(block, wholeRegion(block), {1.5, 8});
  EXPECT_NEAR(part.edgeSeen[4], 1 - 1.0 / 6, 1e-12);
  EXPECT_NEAR(part.edgeSeen[3], 1, 1e-12);  // the far wall, seen down to the floor
  EXPECT_NEAR(part.edgeSeen[5], 0, 1e-12);  // the near wall faces away
}

TEST(AngularSweep, AgreesWithSamplingOnFoldedPolygons) {
  for (const PolygonPhantom& phantom : {makePolygon19(), makePolygon34()}) {
    const Region region = regionBetween(phantom.curve, phantom.first, phantom.last);
    for (const Point2& viewpoint :
         {phantom.viewpoint, Point2(300, 200), Point2(-120, 60), Point2(50, -300)}) {
      const double exact = visiblePart(phantom.curve, region, viewpoint).fraction;
      EXPECT_NEAR(exact, sampledFraction(phantom.curve, region, viewpoint, 400), 2e-3);
    }
  }
}

TEST(AngularSweep, WhatArrivesIsTheFluxWhereNothingHides) {
  // A convex arc that looks at the viewpoint: seen everywhere, so the real visibility is the flux.
  const Curve arc = polygon({{-3, 0}, {3, 0}, {2, 1}, {0, 1.4}, {-2, 1}});
  const Region region{1, 4};
  const VisiblePart open = visiblePart(arc, region, {0.5, 40});
  EXPECT_NEAR(open.fraction, 1, 1e-12);
  EXPECT_NEAR(open.realVisibility, polygonVisibility(arc, region, {0.5, 40}).average, 1e-12);
  // A notch: the floor's seen share with its flux, the hidden rest without.
  const Curve block = polygon({{0, -1}, {6, -1}, {6, 2}, {3, 2}, {3, 0}, {2, 0}, {2, 2}, {0, 2}});
  const Region floor{4, 1};
  const VisiblePart part = visiblePart(block, floor, {1.5, 8});
  EXPECT_NEAR(part.realVisibility, edgeFlux({3, 0}, {2 + 1.0 / 6, 0}, {1.5, 8}).flux, 1e-12);
}

TEST(AngularSweep, RealVisibilityIsNearItsEstimateByTheFlux) {
  for (const PolygonPhantom& phantom : {makePolygon19(), makePolygon34()}) {
    const Region region = regionBetween(phantom.curve, phantom.first, phantom.last);
    const VisiblePart part = visiblePart(phantom.curve, region, phantom.viewpoint);
    const double flux = polygonVisibility(phantom.curve, region, phantom.viewpoint).average;
    // [Thesis, section 4.2]: where every hidden front side has a back side before it, the flux
    // estimates what arrives.
    EXPECT_NEAR(part.realVisibility, flux, 0.06);
    EXPECT_GE(part.fraction, part.realVisibility);
  }
}

TEST(AngularSweep, ViewpointWithinTheCurvesArmsSeesAcrossTheCutOfAngles) {
  // A U around the viewpoint: directions of all angles but those upward.
  const Curve u = polygon({{-3, -3}, {3, -3}, {3, 3}, {2, 3}, {2, -2}, {-2, -2}, {-2, 3}, {-3, 3}});
  const VisiblePart part = visiblePart(u, wholeRegion(u), {0, 0});
  EXPECT_NEAR(part.edgeSeen[3] + part.edgeSeen[4] + part.edgeSeen[5], 3, 1e-12);
  EXPECT_NEAR(part.edgeSeen[0] + part.edgeSeen[1] + part.edgeSeen[7], 0, 1e-12);
}

TEST(AngularSweep, RemovingAnOccluderHidesNothing) {
  const PolygonPhantom phantom = makePolygon34();
  const Region region = regionBetween(phantom.curve, phantom.first, phantom.last);
  const VisiblePart with = visiblePart(phantom.curve, region, phantom.viewpoint);
  // The region's first half alone, as an open chain.
  Curve half;
  half.closed = false;
  const std::vector<int> vertices = verticesOf(phantom.curve, {region.firstEdge, 17});
  half.positions.resize(18, 2);
  for (int k = 0; k < 18; ++k) half.positions.row(k) = phantom.curve.positions.row(vertices[k]);
  const VisiblePart without = visiblePart(half, wholeRegion(half), phantom.viewpoint);
  for (int k = 0; k < 17; ++k) EXPECT_GE(without.edgeSeen[k], with.edgeSeen[k] - 1e-12);
}

}  // namespace
}  // namespace explica::planar
