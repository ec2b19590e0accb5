// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Shapes/AnnulusBoundaries.h"

#include "Explica/Core/Errors.h"
#include "Explica/Planar/PolygonPhantoms.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::shapes {
namespace {

void expectCircle(const planar::Curve& curve, const planar::Point2& centre, double radius,
                  double tolerance) {
  for (int v = 0; v < curve.vertexCount(); ++v) {
    EXPECT_NEAR((curve.point(v) - centre).norm(), radius, tolerance);
  }
}

TEST(AnnulusBoundaries, OfLabelledTissueAreSubPixel) {
  Grid grid;
  grid.size = {80, 80, 2};
  grid.spacing = {0.5, 0.5, 3};
  Volume<Label> labels(grid);
  for (int j = 0; j < 80; ++j) {
    for (int i = 0; i < 80; ++i) {
      const double r =
          (grid.toWorld({double(i), double(j), 1.0}).head<2>() - planar::Point2(20, 20)).norm();
      labels(i, j, 1) = r < 6 ? 7 : (r < 9 ? 2 : (r < 14 ? 3 : 0));
    }
  }
  const AnnulusBoundaries ring = boundariesOfTissue(labels, {7}, {2, 3}, 1);
  expectCircle(ring.inner, {20, 20}, 6, 0.3);
  expectCircle(ring.outer, {20, 20}, 14, 0.3);
  EXPECT_THROW((void)boundariesOfTissue(labels, {7}, {2}, 0), InvalidInput);
  EXPECT_THROW((void)boundariesOfTissue(labels, {}, {2}, 1), InvalidInput);
}

TEST(AnnulusBoundaries, BandOfACircleIsConcentric) {
  const AnnulusBoundaries band = bandAround({planar::makeCircle(200, 20, {5, -3})}, 2);
  expectCircle(band.inner, {5, -3}, 18, 0.02);
  expectCircle(band.outer, {5, -3}, 22, 0.02);
}

TEST(AnnulusBoundaries, BandOfSeveralHoldsThemAll) {
  const std::vector<planar::Curve> targets = {planar::makeEllipse(200, 20, 14),
                                              planar::makeEllipse(200, 15, 19)};
  const AnnulusBoundaries band = bandAround(targets, 1.5);
  const auto reach = [](const planar::Curve& curve, int axis) {
    return curve.positions.col(axis).maxCoeff();
  };
  EXPECT_NEAR(reach(band.inner, 0), 13.5, 0.1);
  EXPECT_NEAR(reach(band.inner, 1), 12.5, 0.1);
  EXPECT_NEAR(reach(band.outer, 0), 21.5, 0.1);
  EXPECT_NEAR(reach(band.outer, 1), 20.5, 0.1);
}

TEST(AnnulusBoundaries, BandsThatCannotBeAreRefused) {
  const planar::Curve circle = planar::makeCircle(200, 20);
  EXPECT_THROW((void)bandAround({}, 1), InvalidInput);
  EXPECT_THROW((void)bandAround({circle}, 0), InvalidInput);
  EXPECT_THROW((void)bandAround({circle}, 21), InvalidInput);
  EXPECT_THROW((void)bandAround({circle}, 1e-3), InvalidInput);
}

}  // namespace
}  // namespace explica::shapes
