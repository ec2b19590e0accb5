// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonVisibility.h"

#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Testing/Curves.h"
#include "FiniteDifference.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>

namespace explica::planar {
namespace {

/// Velocity of a smooth curve's point under the differentiable flow [Thesis, Eq. 4.9].
Point2 continuousFlow(const Point2& point, const Point2& inwardNormal, double curvature,
                      double average, double length, const Point2& viewpoint) {
  return (curvature * average + 1 / (point - viewpoint).norm()) / length * inwardNormal;
}

TEST(EdgeFlux, EqualsQuadrature) {
  const Point2 a(2, 1);
  const Point2 b(-1, 0.5);
  const Point2 viewpoint(0.3, 4);
  const EdgeFlux flux = edgeFlux(a, b, viewpoint);
  const Point2 t = (b - a).normalized();
  const Point2 inward(-t.y(), t.x());
  double sum = 0;
  double squares = 0;
  const int n = 200000;
  for (int k = 0; k < n; ++k) {
    const double f = (a + (k + 0.5) / n * (b - a) - viewpoint).normalized().dot(inward);
    sum += f;
    squares += f * f;
  }
  EXPECT_NEAR(flux.flux, sum / n * (b - a).norm(), 1e-9);
  EXPECT_NEAR(flux.squareFlux, squares / n * (b - a).norm(), 1e-9);
  EXPECT_GT(flux.flux, 0) << "seen from the right of its direction, an edge faces the viewpoint";
  EXPECT_NEAR(edgeFlux(b, a, viewpoint).flux, -flux.flux, 1e-12);
}

// [Thesis, Eq. 4.11 to 4.13] as printed.
TEST(EdgeFlux, EqualsTheThesis) {
  const Point2 a(2, 1);
  const Point2 b(-1, 0.5);
  const Point2 p(0.3, 4);
  const double length = (b - a).norm();
  const double gamma = -(a - p).x() * (b - a).y() + (a - p).y() * (b - a).x();
  const double beta = (b - a).dot(a - p) / length;
  const double printed =
      gamma / length * (std::log(length + beta + (b - p).norm()) - std::log(beta + (a - p).norm()));
  EXPECT_NEAR(edgeFlux(a, b, p).flux, printed, 1e-13);
}

// [Thesis, Eq. 53] with the second bracket's factor gamma/|C|^power; 2 is printed.
Point2 printedDerivative(const Point2& before, const Point2& v, const Point2& p, double power) {
  const Point2 c = v - before;
  const double length = c.norm();
  const Point2 w = before - p;
  const double gamma = -w.x() * c.y() + w.y() * c.x();
  const double beta = c.dot(w) / length;
  const double ahead = length + beta + (v - p).norm();
  const double behind = beta + w.norm();
  const Point2 betaByV = -beta / (length * length) * c + w / length;
  const Point2 gammaByV(w.y(), -w.x());  // (v_{k-1} - P)' J'
  return (std::log(ahead) - std::log(behind)) / length *
             (gammaByV - gamma / (length * length) * c) +
         gamma / std::pow(length, power) *
             ((c / length + betaByV + (v - p) / (v - p).norm()) / ahead - betaByV / behind);
}

TEST(EdgeFlux, GradientShowsTheErratumOfEquation53) {
  const Point2 before(2, 1);
  const Point2 v(-1, 0.5);
  const Point2 p(0.3, 4);
  const Point2 exact = edgeFlux(before, v, p).byEnd;
  EXPECT_LT((exact - printedDerivative(before, v, p, 1)).norm(), 1e-13);
  EXPECT_GT((exact - printedDerivative(before, v, p, 2)).norm(), 1e-2);
}

TEST(EdgeFlux, KeepsItsDigitsNearTheEdgesLineAndFarAway) {
  // The difference of logarithms in the printed form would lose all digits here.
  const EdgeFlux nearLine = edgeFlux({0, 0}, {1, 0}, {5, 1e-9});
  EXPECT_NEAR(nearLine.flux / (-1e-9 * std::log(5.0 / 4.0)), 1, 1e-7);
  const EdgeFlux far = edgeFlux({1, 0}, {0, 0}, {0.5, 1e8});
  EXPECT_NEAR(far.flux, 1, 1e-15);
}

TEST(PolygonVisibility, CircleSeenFromOutsideHasVanishingFluxOverall) {
  // div F = 1/r: the flux into a closed curve is minus the integral of 1/r over its inside.
  const Curve circle = makeCircle(2000, 0.1);
  const double expected = -kPi * 0.01 / 10 / (2 * kPi * 0.1);
  const double average = polygonVisibility(circle, wholeRegion(circle), {0, 10}).average;
  EXPECT_NEAR(average / expected, 1, 1e-3);
}

TEST(PolygonVisibility, IsOneWithoutVarianceOnAnArcAboutTheViewpoint) {
  Curve arc;
  arc.closed = false;
  arc.positions.resize(101, 2);
  for (int k = 0; k <= 100; ++k) {
    const double angle = (60 + 0.6 * k) * kPi / 180;
    arc.positions.row(k) << -5 * std::cos(angle), -5 * std::sin(angle);
  }
  arc.positions = arc.positions.colwise().reverse().eval();
  const PolygonVisibility v = polygonVisibility(arc, wholeRegion(arc), {0, 0});
  EXPECT_NEAR(v.average, 1, 1e-5);
  EXPECT_NEAR(v.variance, 0, 1e-9);
}

TEST(PolygonVisibility, GradientEqualsDifferences) {
  const PolygonPhantom phantom = makePolygon19();
  const Region region = regionBetween(phantom.curve, phantom.first, phantom.last);
  for (const Point2& viewpoint : {phantom.viewpoint, Point2(60, 130)}) {
    const auto average = [&](const Curve& c) {
      return polygonVisibility(c, region, viewpoint).average;
    };
    const Positions2 numeric = centralDifferences(phantom.curve, average, 1e-4);
    const Positions2 exact = polygonVisibility(phantom.curve, region, viewpoint).gradient;
    EXPECT_LT((numeric - exact).norm(), 1e-8 * exact.norm());
  }
}

TEST(PolygonVisibility, RemainderFallsWithTheSquareOfTheStep) {
  const PolygonPhantom phantom = makePolygon34();
  const Region region = regionBetween(phantom.curve, phantom.first, phantom.last);
  const PolygonVisibility at = polygonVisibility(phantom.curve, region, phantom.viewpoint);
  Positions2 direction = Positions2::Zero(phantom.curve.vertexCount(), 2);
  for (int v = 0; v < direction.rows(); ++v) {
    direction.row(v) << std::sin(1.7 * v), std::cos(0.9 * v);
  }
  const double slope = at.gradient.cwiseProduct(direction).sum();
  std::array<double, 3> remainder{};
  for (int k = 0; k < 3; ++k) {
    Curve moved = phantom.curve;
    const double step = 0.1 * std::pow(0.5, k);
    moved.positions += step * direction;
    remainder[k] = std::abs(polygonVisibility(moved, region, phantom.viewpoint).average -
                            at.average - step * slope);
  }
  EXPECT_NEAR(std::log2(remainder[0] / remainder[1]), 2, 0.1);
  EXPECT_NEAR(std::log2(remainder[1] / remainder[2]), 2, 0.1);
}

TEST(PolygonVisibility, DoesNotChangeUnderRigidMotionAndScale) {
  const PolygonPhantom phantom = makePolygon19();
  const Region region = regionBetween(phantom.curve, phantom.first, phantom.last);
  const PolygonVisibility before = polygonVisibility(phantom.curve, region, phantom.viewpoint);
  const Eigen::Matrix2d turn = 4 * Eigen::Rotation2Dd(0.7).toRotationMatrix();
  const Point2 shift(-30, 11);
  Curve moved = phantom.curve;
  for (int v = 0; v < moved.vertexCount(); ++v) {
    moved.positions.row(v) = (turn * phantom.curve.point(v) + shift).transpose();
  }
  const PolygonVisibility after =
      polygonVisibility(moved, region, turn * phantom.viewpoint + shift);
  EXPECT_NEAR(after.average, before.average, 1e-12);
  EXPECT_NEAR(after.variance, before.variance, 1e-12);
}

/// Largest difference over the curve of the polygon's gradient per unit length and (4.9), relative
/// to the flow's largest value.
double flowError(const Curve& curve, const std::function<Point2(int)>& normal,
                 const std::function<double(int)>& curvature) {
  // Half of the curve is the region, so that E is not near zero; its ends belong to the boundary.
  const Point2 viewpoint(0.5, 6);
  const int n = curve.vertexCount();
  const Region region{0, n / 2};
  const PolygonVisibility v = polygonVisibility(curve, region, viewpoint);
  const Eigen::VectorXd lengths = edgeLengths(curve);
  double worst = 0;
  double largest = 0;
  for (int k = 1; k < n / 2; ++k) {
    const Point2 flow =
        continuousFlow(curve.point(k), normal(k), curvature(k), v.average, v.length, viewpoint);
    const Point2 discrete = v.gradient.row(k).transpose() / (0.5 * (lengths[k - 1] + lengths[k]));
    worst = std::max(worst, (flow - discrete).norm());
    largest = std::max(largest, flow.norm());
  }
  EXPECT_GT(v.average, 0.3);
  return worst / largest;
}

TEST(ContinuousFlow, IsTheLimitOfThePolygonsGradientOnACircle) {
  std::array<double, 3> error{};
  for (int k = 0; k < 3; ++k) {
    const int n = 200 << k;
    const Curve circle = makeCircle(n, 2);
    error[k] = flowError(
        circle, [&](int v) { return Point2(-circle.point(v).normalized()); },
        [](int) { return 0.5; });
  }
  EXPECT_LT(error[2], 1e-4);
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.3);
  EXPECT_NEAR(std::log2(error[1] / error[2]), 2, 0.3);
}

TEST(ContinuousFlow, IsTheLimitOfThePolygonsGradientOnAnEllipse) {
  std::array<double, 3> error{};
  for (int k = 0; k < 3; ++k) {
    const int n = 200 << k;
    const double a = 2;
    const double b = 1.2;
    const Curve ellipse = makeEllipse(n, a, b);
    error[k] = flowError(
        ellipse,
        [&](int v) {
          const Point2 p = ellipse.point(v);
          return Point2(-Point2(p.x() / (a * a), p.y() / (b * b)).normalized());
        },
        [&](int v) {
          const Point2 p = ellipse.point(v);
          const double s = p.y() / b;
          const double c = p.x() / a;
          return a * b / std::pow(a * a * s * s + b * b * c * c, 1.5);
        });
  }
  EXPECT_LT(error[2], 1e-3);
  // Unequal edges make the gradient's tangential part first order only where spacing changes fast.
  EXPECT_GT(std::log2(error[0] / error[1]), 0.9);
  EXPECT_GT(std::log2(error[1] / error[2]), 0.9);
}

}  // namespace
}  // namespace explica::planar
