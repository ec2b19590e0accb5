// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonKnotEnergy.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Testing/Curves.h"
#include "FiniteDifference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace explica::planar {
namespace {

double productRule(const Point2& a, const Point2& b, const Point2& c, const Point2& d, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const Point2 x = a + (i + 0.5) / n * (b - a);
    for (int j = 0; j < n; ++j) sum += 1 / (x - c - (j + 0.5) / n * (d - c)).norm();
  }
  return sum / n / n * (b - a).norm() * (d - c).norm();
}

using Pair = std::array<Point2, 4>;

void expectGradientEqualsDifferences(const Pair& p, bool joined) {
  const auto value = [&](const Pair& q) {
    return joined ? joinedEdgesIntegral(q[0], q[1], q[3]).value
                  : apartEdgesIntegral(q[0], q[1], q[2], q[3]).value;
  };
  const EdgePairIntegral exact =
      joined ? joinedEdgesIntegral(p[0], p[1], p[3]) : apartEdgesIntegral(p[0], p[1], p[2], p[3]);
  for (int k = 0; k < 4; ++k) {
    for (int axis = 0; axis < 2; ++axis) {
      Pair up = p;
      Pair down = p;
      const double step = 1e-5;
      up[k][axis] += step;
      down[k][axis] -= step;
      const double numeric = (value(up) - value(down)) / (2 * step);
      EXPECT_NEAR(exact.gradient[k][axis], numeric, 1e-6 * (1 + std::abs(numeric)))
          << "vertex " << k << " axis " << axis;
    }
  }
}

TEST(EdgePairIntegral, EqualsTheProductRuleForEdgesApart) {
  const Pair p = {Point2(0, 0), Point2(1, 0.2), Point2(0.3, 1), Point2(1.5, 0.7)};
  EXPECT_NEAR(apartEdgesIntegral(p[0], p[1], p[2], p[3]).value,
              productRule(p[0], p[1], p[2], p[3], 400), 1e-6);
}

TEST(EdgePairIntegral, ClosedFormAndPanelsAgree) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 500; ++trial) {
    Pair p;
    for (Point2& q : p) q = {uniform(random), uniform(random)};
    p[2] += Point2(2.5, 0);
    p[3] += Point2(2.5, 0);
    const EdgePairIntegral exact = apartEdgesIntegral(p[0], p[1], p[2], p[3]);
    const EdgePairIntegral panels = apartEdgesQuadrature(p[0], p[1], p[2], p[3]);
    ASSERT_NEAR(exact.value, panels.value, 1e-8 * panels.value);
    for (int k = 0; k < 4; ++k) {
      ASSERT_LT((exact.gradient[k] - panels.gradient[k]).norm(), 1e-6) << "trial " << trial;
    }
  }
}

TEST(EdgePairIntegral, IsExactForParallelEdges) {
  // Second antiderivative of 1/sqrt(x^2 + h^2).
  const double h = 0.3;
  const auto f = [&](double x) { return x * std::asinh(x / h) - std::hypot(x, h); };
  const double exact = f(1.0) - f(0.0) - f(0.0) + f(-1.0);
  EXPECT_NEAR(apartEdgesIntegral({0, 0}, {1, 0}, {0, h}, {1, h}).value, exact, 1e-9);
  // Continuous across the change of method.
  for (const double tilt : {0.5e-3, 0.999e-3, 1.001e-3, 2e-3}) {
    EXPECT_NEAR(apartEdgesIntegral({0, 0}, {1, 0}, {0, h}, {1, h + tilt}).value,
                apartEdgesQuadrature({0, 0}, {1, 0}, {0, h}, {1, h + tilt}).value, 1e-9);
  }
}

TEST(EdgePairIntegral, IsExactForJoinedCollinearEdges) {
  // integral over [0,1] x [1,2] of 1/(y - x) = 2 ln 2.
  EXPECT_NEAR(joinedEdgesIntegral({0, 0}, {1, 0}, {2, 0}).value, 2 * std::log(2), 1e-14);
}

TEST(EdgePairIntegral, OfJoinedEdgesIsTheLimitOfEdgesApart) {
  const Point2 a(0, 0);
  const Point2 b(1, 0.3);
  const Point2 d(1.6, -0.5);
  const double gap = 1e-9;
  const Point2 c = b + gap * (d - b);
  EXPECT_NEAR(joinedEdgesIntegral(a, b, d).value, apartEdgesQuadrature(a, b, c, d).value, 1e-6);
}

TEST(EdgePairIntegral, GradientEqualsDifferences) {
  expectGradientEqualsDifferences({Point2(0, 0), Point2(1, 0.2), Point2(0.3, 1), Point2(1.5, 0.7)},
                                  false);
  // Close to contact, crossing lines within both edges' reach.
  expectGradientEqualsDifferences({Point2(0, 0), Point2(1, 0), Point2(0.4, 0.02), Point2(0.5, 1)},
                                  false);
  // Parallel, by panels.
  expectGradientEqualsDifferences({Point2(0, 0), Point2(1, 0), Point2(0.2, 0.3), Point2(1.4, 0.3)},
                                  false);
  expectGradientEqualsDifferences({Point2(0, 0), Point2(1, 0.3), Point2(0, 0), Point2(1.2, -0.5)},
                                  true);
  expectGradientEqualsDifferences({Point2(0, 0), Point2(1, 0), Point2(0, 0), Point2(0.2, 0.1)},
                                  true);
}

TEST(EdgePairIntegral, TouchingInAPointStaysFinite) {
  const double touching = apartEdgesQuadrature({0, 0}, {1, 0}, {0.5, 1e-12}, {0.5, 1}).value;
  EXPECT_TRUE(std::isfinite(touching));
  EXPECT_LT(touching, 10);
}

std::vector<bool> all(const Curve& curve) {
  return std::vector<bool>(curve.vertexCount(), true);
}

double energyOf(const Curve& curve) {
  return PolygonKnotEnergy(PolygonKnot::AllPairs, curve, all(curve))
      .evaluate(curve.positions)
      .value;
}

TEST(PolygonKnotEnergy, DoesNotChangeWhenAnEdgeIsSplit) {
  // Holds with the weight 1 of the first sum of (4.19), not with the printed 2.
  const Curve curve = makePolygon19().curve;
  Curve split;
  split.positions.resize(2 * curve.vertexCount(), 2);
  for (int v = 0; v < curve.vertexCount(); ++v) {
    split.positions.row(2 * v) = curve.positions.row(v);
    split.positions.row(2 * v + 1) =
        0.3 * curve.positions.row(v) + 0.7 * curve.positions.row(curve.next(v));
  }
  EXPECT_NEAR(energyOf(split) / energyOf(curve), 1, 1e-10);
}

TEST(PolygonKnotEnergy, GradientEqualsDifferences) {
  const Curve curve = makePolygon19().curve;
  const Positions2 numeric = centralDifferences(curve, energyOf, 1e-4);
  const Positions2 exact = PolygonKnotEnergy(PolygonKnot::AllPairs, curve, all(curve))
                               .evaluate(curve.positions)
                               .gradient;
  EXPECT_LT((numeric - exact).norm(), 1e-7 * exact.norm());
}

TEST(PolygonKnotEnergy, GradientWithVerticesAtRestIsThatOfThoseThatMove) {
  const Curve curve = makePolygon19().curve;
  std::vector<bool> some(curve.vertexCount(), false);
  for (int v = 3; v < 9; ++v) some[v] = true;
  const Positions2 whole = PolygonKnotEnergy(PolygonKnot::AllPairs, curve, all(curve))
                               .evaluate(curve.positions)
                               .gradient;
  const auto energy = PolygonKnotEnergy(PolygonKnot::AllPairs, curve, some);
  const Positions2 part = energy.evaluate(curve.positions).gradient;
  for (int v = 0; v < curve.vertexCount(); ++v) {
    const Eigen::RowVector2d expected =
        some[v] ? Eigen::RowVector2d(whole.row(v)) : Eigen::RowVector2d::Zero();
    EXPECT_LT((part.row(v) - expected).norm(), 1e-12);
  }
  // And the value changes as its gradient says.
  const auto value = [&](const Curve& c) { return energy.evaluate(c.positions).value; };
  const Positions2 numeric = centralDifferences(curve, value, 1e-4);
  for (int v = 3; v < 9; ++v) EXPECT_LT((numeric.row(v) - part.row(v)).norm(), 1e-6);
}

TEST(PolygonKnotEnergy, ForcesAndTorqueVanishInAll) {
  const Curve curve = makePolygon34().curve;
  const Positions2 g = PolygonKnotEnergy(PolygonKnot::AllPairs, curve, all(curve))
                           .evaluate(curve.positions)
                           .gradient;
  EXPECT_LT(g.colwise().sum().norm(), 1e-9 * g.norm());
  double torque = 0;
  for (int v = 0; v < curve.vertexCount(); ++v) {
    torque += curve.positions(v, 0) * g(v, 1) - curve.positions(v, 1) * g(v, 0);
  }
  EXPECT_LT(std::abs(torque), 1e-7 * g.norm());
}

TEST(PolygonKnotEnergy, ScalesWithLength) {
  // s E + s ln(s) * length: the finite part is not homogeneous.
  const Curve curve = makePolygon19().curve;
  Curve scaled = curve;
  scaled.positions *= 4;
  const double length = edgeLengths(curve).sum();
  EXPECT_NEAR(energyOf(scaled), 4 * energyOf(curve) + 4 * std::log(4) * length, 1e-8);
}

TEST(PolygonKnotEnergy, AutoTakesPairsWhileTheyAreFewAndTheTreeBeyond) {
  const auto ring = [](int n) {
    Curve curve;
    curve.positions.resize(n, 2);
    for (int v = 0; v < n; ++v) {
      curve.positions.row(v) << std::cos(2 * kPi * v / n), std::sin(2 * kPi * v / n);
    }
    return curve;
  };
  for (const auto& [n, expected] :
       {std::pair{200, PolygonKnot::AllPairs}, std::pair{2400, PolygonKnot::Tree}}) {
    const Curve curve = ring(n);
    const std::vector<bool> moving(n, true);
    const auto valueBy = [&](PolygonKnot method) {
      return PolygonKnotEnergy(method, curve, moving).evaluate(curve.positions);
    };
    const PolygonKnotValue chosen = valueBy(PolygonKnot::Auto), wanted = valueBy(expected);
    EXPECT_EQ(chosen.value, wanted.value) << n;
    EXPECT_EQ(chosen.pairs, wanted.pairs) << n;
  }
}

TEST(PolygonKnotEnergy, TreeTendsToAllPairs) {
  // A wavy ring with many edges, part of it moving.
  Curve ring;
  const int n = 1200;
  ring.positions.resize(n, 2);
  for (int v = 0; v < n; ++v) {
    const double a = 2 * kPi * v / n;
    const double r = 50 + 12 * std::sin(9 * a);
    ring.positions.row(v) << r * std::cos(a), r * std::sin(a);
  }
  std::vector<bool> moving(n, false);
  for (int v = 0; v < 400; ++v) moving[v] = true;
  const PolygonKnotValue exact =
      PolygonKnotEnergy(PolygonKnot::AllPairs, ring, moving).evaluate(ring.positions);
  double before = kInfinity;
  for (const double ratio : {0.5, 0.25, 0.125}) {
    const PolygonKnotValue tree =
        PolygonKnotEnergy(PolygonKnot::Tree, ring, moving, ratio).evaluate(ring.positions);
    const double error = (tree.gradient - exact.gradient).norm() / exact.gradient.norm();
    EXPECT_LT(error, before / 3);
    EXPECT_LT(std::abs(tree.value / exact.value - 1), ratio * ratio * ratio);
    before = error;
    EXPECT_LT(tree.pairs, exact.pairs / 2);
  }
  EXPECT_LT(before, 1e-4);
}

TEST(PolygonKnotEnergy, DoesNotDependOnTheNumberOfThreads) {
  const Curve curve = makePolygon34().curve;
  const int threads = threadCount();
  setThreadCount(1);
  const PolygonKnotValue one =
      PolygonKnotEnergy(PolygonKnot::AllPairs, curve, all(curve)).evaluate(curve.positions);
  setThreadCount(4);
  const PolygonKnotValue four =
      PolygonKnotEnergy(PolygonKnot::AllPairs, curve, all(curve)).evaluate(curve.positions);
  setThreadCount(threads);
  EXPECT_EQ(one.value, four.value);
  EXPECT_EQ(one.gradient, four.gradient);
}

TEST(PolygonKnotEnergy, BadArgumentsAreRefused) {
  const Curve curve = makeCircle(8, 1);
  EXPECT_THROW((void)PolygonKnotEnergy(PolygonKnot::Tree, curve, {true}), InvalidInput);
  EXPECT_THROW((void)PolygonKnotEnergy(PolygonKnot::Tree, curve, all(curve), 1.0), InvalidInput);
  const PolygonKnotValue none =
      PolygonKnotEnergy(PolygonKnot::Off, curve, all(curve)).evaluate(curve.positions);
  EXPECT_EQ(none.value, 0);
  EXPECT_TRUE(none.gradient.isZero(0));
}

}  // namespace
}  // namespace explica::planar
