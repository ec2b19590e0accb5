// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Contours.h"

#include "Explica/Core/Errors.h"
#include "Explica/Correspondence/Measurement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

using namespace explica;
using namespace explica::correspondence;

namespace {

Volume<Label> sliceOf(int width, int height, const std::function<Label(double, double)>& label) {
  Grid grid;
  grid.size = {width, height, 1};
  grid.origin = Point(-0.5 * (width - 1), -0.5 * (height - 1), 7);
  Volume<Label> labels(grid);
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      labels(i, j, 0) = label(i + grid.origin[0], j + grid.origin[1]);
    }
  }
  return labels;
}

/// White matter 1 with nine slots 6 wide and 24 deep that grey matter 2 fills; it lines the top,
/// too.
Label comb(double x, double y) {
  if (std::abs(x) > 58 || y < -20 || y > 13) return 0;
  const double along = std::abs(std::remainder(x, 12.0));
  return y > 10 || (along < 3 && y > -14) ? 2 : 1;
}

Measurement measured(const Volume<Label>& labels, bool perSlice) {
  MeasurementOptions options;
  options.annulus.perSlice = perSlice;
  return measure(harmonic::annulusFromLabels(labels, {{1}, {2}, {}, {}}, options.annulus), options);
}

}  // namespace

TEST(Contours, OfARingAreThreeCircles) {
  const auto labels = sliceOf(48, 48, [](double x, double y) -> Label {
    const double r = std::hypot(x, y);
    return r < 12.3 ? 1 : (r < 18.6 ? 2 : 0);
  });
  const Measurement m = measured(labels, false);
  const auto contours = contoursOf(m.annulus, m.interpolant);
  ASSERT_EQ(contours.size(), 1U);
  const Contour& ring = contours[0];
  EXPECT_TRUE(ring.closed);
  EXPECT_GT(ring.inner.size(), 100U);
  for (std::size_t k = 0; k < ring.inner.size(); ++k) {
    EXPECT_NEAR(ring.inner[k].head<2>().norm(), 12.3, 0.35);
    EXPECT_NEAR(ring.middle[k].head<2>().norm(), 15.45, 0.25);
    EXPECT_NEAR(ring.outer[k].head<2>().norm(), 18.6, 0.35);
    EXPECT_NEAR(ring.thickness[k], 6.3, 0.4);
    EXPECT_EQ(ring.inner[k].z(), 7);
    // Points that belong together lie on one ray.
    EXPECT_LT(std::abs(ring.inner[k].head<2>().normalized().dot(
                  Eigen::Vector2d(ring.outer[k].y(), -ring.outer[k].x()).normalized())),
              0.05);
  }
}

TEST(Contours, EndWhereTissueLeavesTheImage) {
  const auto labels =
      sliceOf(30, 20, [](double, double y) -> Label { return y < -4 ? 1 : (y < 2 ? 2 : 0); });
  const Measurement m = measured(labels, false);
  const auto contours = contoursOf(m.annulus, m.interpolant);
  ASSERT_EQ(contours.size(), 1U);
  EXPECT_FALSE(contours[0].closed);
  EXPECT_EQ(contours[0].inner.size(), 31U);  // of 30 voxels, from face to face
}

TEST(Contours, OfBuriedSulciRunBetweenTheBanks) {
  const Measurement m = measured(sliceOf(130, 50, comb), true);
  EXPECT_GT(m.sulcalVoxels.size(), 100U);
  int deep = 0;
  for (const Contour& contour : contoursOf(m.annulus, m.interpolant)) {
    for (std::size_t k = 0; k < contour.inner.size(); ++k) {
      // Within a slot, away from its floor, its mouth and the outermost teeth.
      if (std::abs(contour.middle[k].x()) > 50 || contour.middle[k].y() < -9 ||
          contour.middle[k].y() > 0) {
        continue;
      }
      ++deep;
      EXPECT_NEAR(contour.thickness[k], 3, 0.35);
    }
  }
  EXPECT_GT(deep, 80);
}

TEST(Contours, AreOfSlicesThatStandAlone) {
  harmonic::Annulus annulus;
  EXPECT_THROW((void)contoursOf(annulus, {}), InvalidInput);
}

TEST(Measurement, TellsACortexFromAHeartWallSliceBySlice) {
  // A cavity with two papillary muscles keeps its folds; a cortex's sulci are recovered.
  const auto heart = sliceOf(60, 60, [](double x, double y) -> Label {
    const double r = std::hypot(x, y);
    const bool muscle = std::hypot(x - 11, y) < 4 || std::hypot(x, y - 12) < 3.5;
    return r < 16 && !muscle ? 1 : (r < 24 ? 2 : 0);
  });
  EXPECT_LT(foldingOf(measured(heart, true).annulus), 2);
  EXPECT_TRUE(measured(heart, true).sulcalVoxels.empty());
  EXPECT_GT(foldingOf(measured(sliceOf(130, 50, comb), false).annulus), 3.5);
}
