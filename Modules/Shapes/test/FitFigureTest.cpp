// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Shapes/FitFigure.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Planar/PolygonPhantoms.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::shapes {
namespace {

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(FitFigure, SectionOfASphereIsACircle) {
  const double z = 0.3;
  const Outline outline = sectionOf(geometry::makeIcosphere(5), z);
  double length = 0;
  for (const auto& segment : outline) {
    length += (segment[1] - segment[0]).norm();
    EXPECT_NEAR(segment[0].norm(), std::sqrt(1 - z * z), 2e-3);
  }
  EXPECT_NEAR(length, 2 * kPi * std::sqrt(1 - z * z), 2e-3);
}

TEST(FitFigure, SectionThroughVerticesIsStillClosed) {
  // The icosphere's equator of refined edges: every end of a segment is met by another.
  const Outline outline = sectionOf(geometry::makeIcosphere(2), 0);
  for (const auto& segment : outline) {
    for (const auto& end : segment) {
      int met = 0;
      for (const auto& other : outline) {
        met += (other[0] - end).norm() < 1e-12;
        met += (other[1] - end).norm() < 1e-12;
      }
      EXPECT_EQ(met % 2, 0);
    }
  }
}

TEST(FitFigure, DrawsTargetAndShapeInEveryPanel) {
  const HarmonicAnnulus annulus{2, Point::Zero(), 1, 3, 4};
  const Outline circle = outlineOf(planar::makeCircle(30, 2));
  const std::string svg =
      drawFit(annulus, 0, circle, {{"start", circle, 3, 1}, {"iteration 4", circle, 0.1, 0.02}});
  EXPECT_EQ(countOf(svg, "<path"), 4U + 4U) << "two a panel, and the legend's";
  EXPECT_EQ(countOf(svg, "<circle"), 4U);
  EXPECT_EQ(countOf(svg, "iteration 4"), 1U);
  EXPECT_THROW((void)drawFit(annulus, 0, circle, {}), InvalidInput);
}

TEST(FitFigure, DrawsAGivenAnnulusByItsBoundaries) {
  const HarmonicAnnulus annulus =
      givenAnnulus(planar::makeEllipse(20, 2, 1), planar::makeEllipse(30, 5, 4), 4);
  const Outline circle = outlineOf(planar::makeCircle(30, 3));
  const std::string svg = drawFit(annulus, 0, circle, {{"start", circle, 3, 1}});
  EXPECT_EQ(countOf(svg, "<polygon"), 2U);
  EXPECT_EQ(countOf(svg, "<circle"), 0U);
}

}  // namespace
}  // namespace explica::shapes
