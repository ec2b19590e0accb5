// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Shapes/AnnulusMap.h"

#include "Explica/Core/Errors.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Shapes/HarmonicAnnulus.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace explica::shapes {
namespace {

using planar::Curve;
using planar::makeCircle;
using planar::makeEllipse;
using planar::Point2;

Curve polygon(const std::vector<Point2>& points) {
  Curve curve;
  curve.positions.resize(static_cast<Eigen::Index>(points.size()), 2);
  for (std::size_t v = 0; v < points.size(); ++v) {
    curve.positions.row(static_cast<Eigen::Index>(v)) = points[v].transpose();
  }
  return curve;
}

/// The harmonic interpolant, 0 on the inner and 1 on the outer boundary.
double interpolant(const AnnulusMap& map, const Point2& p) {
  return std::log(map(p).norm() / map.innerRadius()) /
         std::log(map.outerRadius() / map.innerRadius());
}

TEST(AnnulusMap, OfConcentricCirclesIsTheTranslation) {
  const Point2 centre(3, -7);
  const AnnulusMap map(makeCircle(400, 4, centre), makeCircle(400, 11, centre));
  EXPECT_NEAR(map.innerRadius(), 4, 1e-3);
  EXPECT_NEAR(map.outerRadius(), 11, 1e-3);
  EXPECT_NEAR(map.meanWidth(), 7, 1e-3);
  for (const Point2& p : {Point2(6, 0), Point2(0, 10.9), Point2(-4.02, 0), Point2(-5, -5)}) {
    EXPECT_LT((map(centre + p) - p).norm(), 1e-3);
  }
}

// u of eccentric circles in bipolar coordinates: the circles are |z - p| = k |z - q|.
TEST(AnnulusMap, OfEccentricCirclesIsMoebiusAtSecondOrder) {
  const double r = 4;
  const double R = 10;
  const double shift = 3;  // of the inner centre, along x
  // Limit points of the pencil, inverse to each other in both circles.
  const double m = (R * R - r * r + shift * shift) / (2 * shift);
  const double root = std::sqrt(m * m - R * R);
  const double p = m - root;
  const double q = m + root;
  const auto ratio = [&](const Point2& z) {
    return std::log((z - Point2(p, 0)).norm() / (z - Point2(q, 0)).norm());
  };
  const double inner = ratio({shift + r, 0});
  const double outer = ratio({R, 0});
  std::vector<double> errors;
  for (const int pieces : {50, 100, 200, 400}) {
    const AnnulusMap map(makeCircle(pieces, r, {shift, 0}), makeCircle(pieces, R), pieces);
    EXPECT_NEAR(std::log(map.outerRadius() / map.innerRadius()), outer - inner,
                40.0 / (pieces * pieces));
    double worst = 0;
    for (int k = 0; k < 60; ++k) {
      const double angle = 2 * kPi * k / 60 + 0.1;
      const Point2 direction(std::cos(angle), std::sin(angle));
      for (const double share : {0.15, 0.5, 0.85}) {
        const Point2 from = Point2(shift, 0) + r * direction;
        const Point2 z = from + share * (R * direction - from);
        const double exact = (ratio(z) - inner) / (outer - inner);
        worst = std::max(worst, std::abs(interpolant(map, z) - exact));
      }
    }
    errors.push_back(worst);
  }
  for (std::size_t k = 1; k < errors.size(); ++k) {
    EXPECT_GT(std::log2(errors[k - 1] / errors[k]), 1.7) << errors[k - 1] << " " << errors[k];
    EXPECT_LT(std::log2(errors[k - 1] / errors[k]), 2.6) << errors[k - 1] << " " << errors[k];
  }
  EXPECT_LT(errors.back(), 1e-4);
}

// z = (w + 1/w) c / 2 maps concentric circles onto confocal ellipses.
TEST(AnnulusMap, OfConfocalEllipsesIsJoukowskys) {
  const double focal = 6;
  const auto axes = [&](double s) {
    return std::pair{focal / 2 * (s + 1 / s), focal / 2 * (s - 1 / s)};
  };
  const auto [a0, b0] = axes(1.5);
  const auto [a1, b1] = axes(3.0);
  const AnnulusMap map(makeEllipse(400, a0, b0), makeEllipse(400, a1, b1));
  EXPECT_NEAR(map.outerRadius() / map.innerRadius(), 2, 1e-3);
  for (int k = 0; k < 40; ++k) {
    const double t = 2 * kPi * k / 40;
    const double s = 2.1;
    const auto [a, b] = axes(s);
    const Point2 w = map({a * std::cos(t), b * std::sin(t)});
    EXPECT_NEAR(w.norm() / map.outerRadius(), s / 3, 2e-4);
    EXPECT_NEAR(std::remainder(std::atan2(w.y(), w.x()) - t, 2 * kPi), 0, 1e-3);
  }
}

TEST(AnnulusMap, OfAnnuliWithCornersMeetsItsBoundariesAndIsHarmonic) {
  const Curve outer = polygon({{0, 0}, {30, 0}, {30, 12}, {14, 12}, {14, 30}, {0, 30}});
  const Curve inner = polygon({{4, 4}, {10, 4}, {10, 7}, {7, 7}, {7, 24}, {4, 24}});
  const AnnulusMap map(inner, outer);
  const Point2 p(20, 6);
  for (const double h : {0.4, 0.2}) {
    const double laplacian = interpolant(map, p + Point2(h, 0)) +
                             interpolant(map, p - Point2(h, 0)) +
                             interpolant(map, p + Point2(0, h)) +
                             interpolant(map, p - Point2(0, h)) - 4 * interpolant(map, p);
    EXPECT_LT(std::abs(laplacian), 1e-4 * h * h);
  }
  double worst = 0;
  for (double x = 1; x < 30; x += 0.37) worst = std::max(worst, 1 - interpolant(map, {x, 1e-3}));
  for (double y = 5; y < 23; y += 0.37) worst = std::max(worst, interpolant(map, {4 - 1e-3, y}));
  EXPECT_LT(worst, 5e-3);
  // A finer division tells the error: it is small against u's range of 1.
  const AnnulusMap finer(inner, outer, 800);
  for (const Point2& z : {Point2(12, 9), Point2(15, 2), Point2(2, 27), Point2(10.5, 20)}) {
    EXPECT_NEAR(interpolant(map, z), interpolant(finer, z), 2e-3);
  }
}

TEST(AnnulusMap, SidesAreToldAndOutsideTakesTheNearestBoundary) {
  const AnnulusMap map(makeCircle(100, 4, {1, 0}), makeCircle(100, 10));
  EXPECT_EQ(map.sideOf({1, 1}), AnnulusSide::Enclosed);
  EXPECT_EQ(map.sideOf({-6, 1}), AnnulusSide::Inside);
  EXPECT_EQ(map.sideOf({9, 9}), AnnulusSide::Beyond);
  EXPECT_NEAR(map({12, 0}).norm(), map.outerRadius(), 1e-9);
  EXPECT_NEAR(map({1, 0.5}).norm(), map.innerRadius(), 0.02);
  // A node itself, where the logarithms are infinite.
  EXPECT_NEAR(map({10, 0}).norm(), map.outerRadius(), 1e-9);
}

TEST(AnnulusMap, DoesNotDependOnOrientationOrPlace) {
  const Curve inner = makeEllipse(80, 5, 3);
  const Curve outer = makeEllipse(90, 12, 9);
  Curve turned = outer;
  turned.positions = outer.positions.colwise().reverse().eval();
  Curve movedInner = inner;
  Curve movedOuter = outer;
  movedInner.positions.rowwise() += Eigen::RowVector2d(512, -256);
  movedOuter.positions.rowwise() += Eigen::RowVector2d(512, -256);
  const AnnulusMap a(inner, outer);
  const AnnulusMap b(inner, turned);
  const AnnulusMap c(movedInner, movedOuter);
  EXPECT_LT((a({8, 1}) - b({8, 1})).norm(), 1e-6);
  EXPECT_LT((a({8, 1}) - c({520, -255})).norm(), 1e-8);
}

TEST(AnnulusMap, WrongBoundariesAreRefused) {
  const Curve circle = makeCircle(40, 5);
  EXPECT_THROW(AnnulusMap(circle, makeCircle(40, 5, {3, 0})), InvalidInput) << "they meet";
  EXPECT_THROW(AnnulusMap(circle, makeCircle(40, 5, {20, 0})), InvalidInput) << "beside";
  EXPECT_THROW(AnnulusMap(makeCircle(40, 9), circle), InvalidInput) << "inside out";
  EXPECT_THROW(AnnulusMap(polygon({{0, 0}, {1, 1}, {1, 0}, {0, 1}}), circle), InvalidInput);
  Curve open = makeCircle(40, 2);
  open.closed = false;
  EXPECT_THROW(AnnulusMap(open, circle), InvalidInput);
}

}  // namespace
}  // namespace explica::shapes
