// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonMeasures.h"

#include "Explica/Core/Errors.h"
#include "Explica/Planar/AngularSweep.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "FiniteDifference.h"
#include "Polygon.h"

#include <gtest/gtest.h>

#include <cmath>

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

/// Follows the negative gradient with steps that shrink to nothing; the measures have kinks.
Curve descend(Curve curve, const std::function<double(const Curve&)>& measure, int iterations) {
  for (int k = 0; k < iterations; ++k) {
    const Positions2 gradient = centralDifferences(curve, measure, 1e-6);
    const double size = gradient.rowwise().norm().maxCoeff();
    if (!(size > 1e-9)) break;
    const double step = 0.04 * (1 - static_cast<double>(k) / iterations);
    curve.positions -= step / size * gradient;
  }
  return curve;
}

TEST(GlobalMeasures, TheirFlowsDoNotUnfold) {
  // What section 4.1 says: the flows shrink what is folded; they do not bring it out at its length.
  const Curve start =
      polygon({{-3, -2}, {3, -2}, {3, 2}, {0.8, 2}, {0.5, 0}, {-0.5, 0}, {-0.8, 2}, {-3, 2}});
  const Region notch{3, 3};
  const double length = lengthOf(start, notch);

  const Curve convex = descend(start, selfOcclusion, 600);
  EXPECT_LT(selfOcclusion(convex), 0.1 * selfOcclusion(start)) << "it becomes nearly convex";
  EXPECT_LT(lengthOf(convex, notch), 0.75 * length) << "but the walls are lost on the way";

  const Curve smooth = descend(
      start, [](const Curve& c) { return hiddenViewingArc(c, Point2::Zero(), 100); }, 150);
  EXPECT_LT(edgeLengths(smooth).sum(), 0.8 * edgeLengths(start).sum()) << "curve shortening";
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
