// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/GlobalFlow.h"
#include "Explica/Planar/PolygonMeasures.h"

#include "Explica/Core/Errors.h"
#include "Explica/Planar/AngularSweep.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "FiniteDifference.h"
#include "Polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace explica::planar {
namespace {

/// A square with a notch in its upper side.
Curve notched() {
  return polygon({{-3, -2}, {3, -2}, {3, 2}, {0.5, 2}, {0.5, 0}, {-0.5, 0}, {-0.5, 2}, {-3, 2}});
}

/// [Thesis, Eq. 4.6] by the product rule.
double doubleIntegral(const Curve& curve, double radius, int perEdge) {
  double sum = 0;
  for (int i = 0; i < curve.edgeCount(); ++i) {
    const Point2 a = curve.point(i);
    const Point2 b = curve.point(curve.next(i));
    for (int p = 0; p < perEdge; ++p) {
      const Point2 x = a + (p + 0.5) / perEdge * (b - a);
      for (int j = 0; j < curve.edgeCount(); ++j) {
        if (j == i) continue;
        const Point2 c = curve.point(j);
        const Point2 t = curve.point(curve.next(j)) - c;
        for (int q = 0; q < perEdge; ++q) {
          const Point2 d = c + (q + 0.5) / perEdge * t - x;
          const double turn = x.x() * d.y() - x.y() * d.x();
          const double factor =
              1 - x.dot(d) / std::sqrt(d.squaredNorm() * radius * radius - turn * turn);
          sum += radius * factor * (d.x() * t.y() - d.y() * t.x()) / d.squaredNorm() / perEdge *
                 (b - a).norm() / perEdge;
        }
      }
    }
  }
  return sum;
}

TEST(HiddenViewingArc, EqualsItsDoubleIntegral) {
  EXPECT_NEAR(hiddenViewingArc(notched(), Point2::Zero(), 10) / doubleIntegral(notched(), 10, 300),
              1, 2e-3);
}

TEST(HiddenViewingArc, OfACircleIsTheArcBehindItsTangent) {
  const double a = 2;
  const double r = 5;
  EXPECT_NEAR(hiddenViewingArc(makeCircle(20000, a), Point2::Zero(), r),
              2 * kPi * a * r * (2 * kPi - 2 * std::acos(a / r)), 1e-4);
}

TEST(HiddenViewingArc, ItsFlowIsCurvatureTimesAConstant) {
  // For a large circle the gradient per unit length is -pi r kappa N: it smooths.
  const int n = 400;
  const Curve ellipse = makeEllipse(n, 2, 1.2);
  const double r = 1e6;
  const auto energy = [&](const Curve& c) { return hiddenViewingArc(c, Point2::Zero(), r) / r; };
  const Positions2 gradient = centralDifferences(ellipse, energy, 1e-4);
  const Eigen::VectorXd lengths = edgeLengths(ellipse);
  for (int v = 1; v < n; v += 7) {
    const Point2 p = ellipse.point(v);
    const double c = p.x() / 2;
    const double s = p.y() / 1.2;
    const double curvature = 2 * 1.2 / std::pow(4 * s * s + 1.44 * c * c, 1.5);
    const Point2 inward = -Point2(p.x() / 4, p.y() / 1.44).normalized();
    const Point2 flow = gradient.row(v).transpose() / (0.5 * (lengths[v] + lengths[v - 1]));
    EXPECT_LT((flow + kPi * curvature * inward).norm(), 0.02 * kPi * curvature);
  }
}

TEST(SelfOcclusion, IsZeroForConvexPolygons) {
  EXPECT_EQ(selfOcclusion(polygon({{0, 0}, {4, 0}, {5, 3}, {1, 4}})), 0);
  EXPECT_NEAR(selfOcclusion(makeCircle(333, 2)), 0, 1e-9);
}

TEST(SelfOcclusion, OfANotchIsWhatItsWallsHide) {
  // Pairs of walls: each sees the other and the floor, and the floor both walls.
  EXPECT_NEAR(selfOcclusion(notched()), 2 * 2 * 2 + 4 * 2 * 1, 1e-12);
}

TEST(SelfOcclusion, EqualsSampling) {
  const Curve curve = makePolygon19().curve;
  double sum = 0;
  const int n = 60;
  for (int i = 0; i < curve.edgeCount(); ++i) {
    const Point2 ti = curve.point(curve.next(i)) - curve.point(i);
    for (int j = 0; j < curve.edgeCount(); ++j) {
      if (i == j) continue;
      const Point2 tj = curve.point(curve.next(j)) - curve.point(j);
      for (int p = 0; p < n; ++p) {
        for (int q = 0; q < n; ++q) {
          const Point2 d =
              curve.point(j) + (q + 0.5) / n * tj - curve.point(i) - (p + 0.5) / n * ti;
          const bool yShows = -d.x() * tj.y() + d.y() * tj.x() > 0;
          const bool xShows = d.x() * ti.y() - d.y() * ti.x() > 0;
          if (yShows && xShows) sum += ti.norm() * tj.norm() / n / n;
        }
      }
    }
  }
  EXPECT_NEAR(selfOcclusion(curve) / sum, 1, 0.01);
}

/// A flower of seven petals.
Curve flower(int n, double noise = 0) {
  std::mt19937 generator(3);
  std::uniform_real_distribution<double> uniform(-noise, noise);
  Curve curve;
  curve.positions.resize(n, 2);
  for (int v = 0; v < n; ++v) {
    const double t = 2 * kPi * v / n;
    const double r = 30 + 12 * std::sin(7 * t) + uniform(generator);
    curve.positions.row(v) << r * std::cos(t), r * std::sin(t);
  }
  return curve;
}

TEST(SelfOcclusion, OfRunsOfEdgesIsThatOfTheirPairs) {
  for (const int n : {33, 64, 700}) {
    for (const double noise : {0.0, 0.5}) {
      const Curve curve = flower(n, noise);
      EXPECT_NEAR(selfOcclusion(curve) / selfOcclusionGradient(curve).value, 1, 1e-12) << n;
    }
  }
}

/// 5e9 pairs: not one by one.  Of first order, as an edge is hidden up to where a line meets it.
TEST(SelfOcclusion, OfAHundredThousandEdgesIsTheLimitOfAThousand) {
  const double limit = selfOcclusion(flower(100000));
  const double coarse = selfOcclusion(flower(1000)), fine = selfOcclusion(flower(4000));
  EXPECT_NEAR((coarse - limit) / (fine - limit), 4, 0.5);
}

TEST(GlobalMeasures, GradientsEqualDifferences) {
  const Curve curve = makePolygon34().curve;
  const ViewingCircle circle = viewingCircle(curve, {});
  const auto arc = [&](const Curve& c) {
    return hiddenViewingArc(c, circle.centre, circle.radius);
  };
  const auto expectNear = [](const Positions2& exact, const Positions2& differences) {
    EXPECT_LT((exact - differences).norm(), 1e-6 * differences.norm());
  };
  const MeasureValue byArc = hiddenViewingArcGradient(curve, circle.centre, circle.radius);
  EXPECT_DOUBLE_EQ(byArc.value, arc(curve));
  expectNear(byArc.gradient, centralDifferences(curve, arc, 1e-3));
  const MeasureValue byHiding = selfOcclusionGradient(curve);
  EXPECT_NEAR(byHiding.value / selfOcclusion(curve), 1, 1e-12);
  expectNear(byHiding.gradient, centralDifferences(curve, selfOcclusion, 1e-5));
}

TEST(GlobalFlow, NeitherMeasureUnfolds) {
  // What section 4.1 says: the flows shrink what is folded; they do not bring it out at its length.
  const PolygonPhantom phantom = makePolygon19();
  const Region region = regionBetween(phantom.curve, phantom.first, phantom.last);
  GlobalFlowOptions options;
  const GlobalFlow convex = descendGlobalMeasure(phantom.curve, region, phantom.viewpoint, options);
  EXPECT_LT(convex.history.back().measure, 0.2 * convex.history.front().measure);
  EXPECT_LT(convex.history.back().length, 0.75 * convex.history.front().length);

  options.measure = GlobalMeasure::HiddenArc;
  options.maxIterations = 600;
  const GlobalFlow smooth = descendGlobalMeasure(phantom.curve, region, phantom.viewpoint, options);
  EXPECT_LT(smooth.history.back().length, 0.8 * smooth.history.front().length);
  // To first order in 1/r the measure is pi r times the length, whose flow is curve shortening.
  const ViewingCircle circle = viewingCircle(phantom.curve, {});
  EXPECT_NEAR(smooth.history.back().measure, kPi * circle.radius * edgeLengths(smooth.curve).sum(),
              0.1 * smooth.history.back().measure);
}

TEST(GlobalFlow, LeavesAConvexPolygonToItsSecondMeasure) {
  const Curve circle = makeCircle(40, 5);
  const GlobalFlow flow = descendGlobalMeasure(circle, wholeRegion(circle), {0, 100}, {});
  EXPECT_EQ(flow.termination, Termination::Converged);
  EXPECT_LT((flow.curve.positions - circle.positions).norm(), 1e-6);
}

TEST(GlobalMeasures, BadArgumentsAreRefused) {
  Curve open = notched();
  open.closed = false;
  EXPECT_THROW((void)selfOcclusion(open), InvalidInput);
  EXPECT_THROW((void)hiddenViewingArc(open, Point2::Zero(), 10), InvalidInput);
  EXPECT_THROW((void)hiddenViewingArc(notched(), Point2::Zero(), 3), InvalidInput);
}

}  // namespace
}  // namespace explica::planar
