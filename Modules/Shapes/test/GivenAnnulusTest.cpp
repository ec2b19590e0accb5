// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Shapes in annuli of the plane that are not circular.

#include "Explica/Core/Errors.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Shapes/AnnulusBoundaries.h"
#include "Explica/Shapes/ShapeFit.h"
#include "Explica/Shapes/ShapeLevel.h"
#include "Lobed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

namespace explica::shapes {
namespace {

using planar::Curve;
using planar::Point2;

double farthest(const Curve& a, const Curve& b) {
  return std::max(distanceBetween(a, b).max, distanceBetween(b, a).max);
}

double halfVoxel(const HarmonicAnnulus& annulus, int voxels) {
  return boxOf(annulus).halfSide / (voxels - 1);
}

Curve curveOf(const HarmonicShape& shape, int voxels) {
  const std::vector<Curve> curves = levelCurves(shape, voxels);
  EXPECT_EQ(curves.size(), 1U);
  return curves.front();
}

TEST(GivenAnnulus, BetweenConcentricCirclesIsTheCircularOne) {
  const HarmonicAnnulus circular{2, Point(3, 4, 0), 12.5, 29, 24};
  const HarmonicAnnulus given =
      givenAnnulus(planar::makeCircle(500, 12.5, {3, 4}), planar::makeCircle(500, 29, {3, 4}), 24);
  Curve target = lobed(3, 0.2, 0.4);
  target.positions.rowwise() += Eigen::RowVector2d(3, 4);
  const TargetSamples samples = samplesOf(target, 400);
  const HarmonicShape a = fitShape(circular, samples).shape;
  const HarmonicShape b = fitShape(given, samples).shape;
  EXPECT_LT((a.inner - b.inner).cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_LT((a.outer - b.outer).cwiseAbs().maxCoeff(), 2e-3);
  EXPECT_LT(farthest(curveOf(a, 96), curveOf(b, 96)), 0.02);
}

TEST(GivenAnnulus, OfACircularImageIsTheCircularOneToAFractionOfAPixel) {
  Grid grid;
  grid.size = {150, 150, 1};
  grid.spacing = {0.5, 0.5, 1};
  grid.origin = {-37.25, -37.25, 0};
  Volume<Label> labels(grid);
  for (int j = 0; j < 150; ++j) {
    for (int i = 0; i < 150; ++i) {
      const double r = grid.toWorld({double(i), double(j), 0.0}).norm();
      labels(i, j, 0) = r < 12.5 ? 1 : (r < 29 ? 2 : 0);
    }
  }
  const AnnulusBoundaries ring = boundariesOfTissue(labels, {1}, {2}, 0);
  const HarmonicAnnulus given = givenAnnulus(ring.inner, ring.outer, 24);
  EXPECT_NEAR(given.innerRadius, 12.5, 0.1);
  EXPECT_NEAR(given.outerRadius, 29, 0.1);
  // The harmonic interpolant, then a fit.
  Positions points(40, 3);
  for (int p = 0; p < 40; ++p) {
    const double angle = 2 * kPi * p / 40;
    points.row(p) << (14 + 0.35 * p) * std::cos(angle), (14 + 0.35 * p) * std::sin(angle), 0;
  }
  const Eigen::VectorXd u = valuesAt(concentricShape(given), points);
  for (int p = 0; p < 40; ++p) {
    EXPECT_NEAR(u[p], std::log(points.row(p).norm() / 12.5) / std::log(29 / 12.5), 0.01);
  }
  const TargetSamples samples = samplesOf(lobed(3, 0.2, 0.4), 400);
  const HarmonicAnnulus circular{2, Point::Zero(), 12.5, 29, 24};
  EXPECT_LT(farthest(curveOf(fitShape(given, samples).shape, 96),
                     curveOf(fitShape(circular, samples).shape, 96)),
            0.1);
}

// The level 1/2 between eccentric circles is the circle of their pencil half way in bipolar tau.
TEST(GivenAnnulus, LevelBetweenEccentricCirclesIsACircle) {
  const double r = 4;
  const double R = 10;
  const double shift = 3;
  const double m = (R * R - r * r + shift * shift) / (2 * shift);
  const double root = std::sqrt(m * m - R * R);
  const double p = m - root;
  const double q = m + root;
  const auto ratio = [&](double x) { return std::abs(x - p) / std::abs(x - q); };
  const double k = std::sqrt(ratio(shift + r) * ratio(R));  // |z - p| = k |z - q|
  const Point2 centre((p - k * k * q) / (1 - k * k), 0);
  const double radius = k * (q - p) / (1 - k * k);
  const HarmonicAnnulus annulus =
      givenAnnulus(planar::makeCircle(400, r, {shift, 0}), planar::makeCircle(400, R));
  const Curve level = curveOf(concentricShape(annulus), 96);
  for (int v = 0; v < level.vertexCount(); ++v) {
    EXPECT_NEAR((level.point(v) - centre).norm(), radius, 1e-3);
  }
}

TEST(GivenAnnulus, FitsBetweenEllipsesAreWithinHalfAVoxelAndTheirMixturesAreOneCurve) {
  const HarmonicAnnulus annulus =
      givenAnnulus(planar::makeEllipse(300, 13, 8), planar::makeEllipse(300, 30, 25));
  std::vector<HarmonicShape> shapes;
  for (const auto& [lobes, depth] : {std::pair{2, 0.2}, {3, 0.12}, {5, 0.05}}) {
    const Curve target = lobed(lobes, depth, 0.3 * lobes);
    shapes.push_back(fitShape(annulus, samplesOf(target, 500)).shape);
    EXPECT_LT(farthest(curveOf(shapes.back(), 96), target), halfVoxel(annulus, 96)) << lobes;
    EXPECT_GT(boundaryMargin(shapes.back()), 0);
  }
  std::mt19937 random(11);
  std::exponential_distribution<double> weight(1);
  for (int trial = 0; trial < 12; ++trial) {
    const HarmonicShape mixed = combine(shapes, {weight(random), weight(random), weight(random)});
    EXPECT_GT(boundaryMargin(mixed), 0) << "seed 11, trial " << trial;
    EXPECT_TRUE(planar::intersectingEdges(curveOf(mixed, 64)).empty());
  }
}

// Lobes as deep as these are beyond a circular annulus, whose boundaries are far from them.
TEST(GivenAnnulus, ABandMeetsDeepLobesThatACircularAnnulusCannot) {
  const Curve target = lobed(5, 0.3, 0);
  const TargetSamples samples = samplesOf(target, 1000);
  const AnnulusBoundaries band = bandAround({target}, 3);
  const HarmonicAnnulus narrow = givenAnnulus(band.inner, band.outer);
  EXPECT_LT(farthest(curveOf(fitShape(narrow, samples).shape, 96), target), halfVoxel(narrow, 96));
  const HarmonicAnnulus circular = annulusAround({samples}, 2);
  EXPECT_GT(farthest(curveOf(fitShape(circular, samples).shape, 96), target), 1);
}

TEST(GivenAnnulus, AMyocardialContourIsWithinHalfAVoxelInABand) {
  const std::filesystem::path file =
      std::filesystem::path(EXPLICA_REAL_DATA) / "lv_sunnybrook_SCD0000101/ED_label.nii.gz";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "skipped: no real data";
  const Volume<Label> labels = io::readLabels(file).volume;
  const Curve target = planar::contoursOfLabel(labels, 2, planar::largestSlice(labels, 2)).front();
  const AnnulusBoundaries band = bandAround({target}, 3);
  const HarmonicAnnulus annulus = givenAnnulus(band.inner, band.outer);
  const HarmonicShape shape = fitShape(annulus, samplesOf(target, 2000)).shape;
  EXPECT_LT(farthest(curveOf(shape, 96), target), halfVoxel(annulus, 96));
  EXPECT_GT(boundaryMargin(shape), 0);
}

TEST(GivenAnnulus, OtherAnnuliAndPointsOutsideAreRefused) {
  const Curve inner = planar::makeEllipse(100, 13, 8);
  const HarmonicAnnulus a = givenAnnulus(inner, planar::makeEllipse(100, 30, 25), 8);
  const HarmonicAnnulus same = givenAnnulus(inner, planar::makeEllipse(100, 30, 25), 8);
  const HarmonicAnnulus b = givenAnnulus(inner, planar::makeEllipse(100, 30, 26), 8);
  EXPECT_NO_THROW((void)combine({concentricShape(a), concentricShape(same)}, {1, 1}));
  EXPECT_THROW((void)combine({concentricShape(a), concentricShape(b)}, {1, 1}), InvalidInput);
  EXPECT_THROW((void)fitShape(a, samplesOf(planar::makeCircle(50, 10), 100)), InvalidInput);
}

}  // namespace
}  // namespace explica::shapes
