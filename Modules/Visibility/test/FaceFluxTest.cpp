// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/FaceFlux.h"

#include "Explica/Testing/TaylorRemainder.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace explica::visibility {
namespace {

const Point kA(0.3, -0.2, 0.1);
const Point kB(1.4, 0.1, -0.3);
const Point kC(0.5, 1.2, 0.4);

/// Flux by the centroids of n^2 sub-triangles and one Richardson step.
double fluxByQuadrature(const Point& a, const Point& b, const Point& c, const Point& p) {
  const auto sum = [&](int n) {
    double total = 0;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        for (int up = 0; up < (i + j + 1 < n ? 2 : 1); ++up) {
          const double u = (i + (1 + up) / 3.0) / n;
          const double v = (j + (1 + up) / 3.0) / n;
          const Vector x = a + u * (b - a) + v * (c - a) - p;
          total -= x.normalized().dot((b - a).cross(c - a)) / 2 / (n * n);
        }
      }
    }
    return total;
  };
  return (4 * sum(400) - sum(200)) / 3;
}

TEST(FaceFlux, EqualsQuadratureFromAnywhere) {
  for (const Point& p : {Point(0.6, 0.5, 2), Point(0.6, 0.5, -2), Point(5, 1, 0.3), Point(-3, 2, 8),
                         Point(0.7, 0.4, 0.6)}) {
    EXPECT_NEAR(faceFlux(kA, kB, kC, p).flux, fluxByQuadrature(kA, kB, kC, p), 1e-8);
  }
}

TEST(FaceFlux, IsPositiveIfTheFaceLooksAtTheViewpoint) {
  const Vector outward = (kB - kA).cross(kC - kA).normalized();
  const Point centre = (kA + kB + kC) / 3;
  EXPECT_GT(faceFlux(kA, kB, kC, centre + outward).flux, 0);
  EXPECT_LT(faceFlux(kA, kB, kC, centre - outward).flux, 0);
}

TEST(FaceFlux, ScalesWithTheSquareOfTheSize) {
  const Point p(1, 2, 3);
  EXPECT_NEAR(faceFlux(8 * kA, 8 * kB, 8 * kC, 8 * p).flux, 64 * faceFlux(kA, kB, kC, p).flux,
              1e-12);
}

TEST(FaceFlux, IsZeroAndFiniteInTheFacesOwnPlane) {
  const Point a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
  for (const Point& p : {Point(0.2, 0.3, 0), Point(0.5, 0, 0), Point(2, 0, 0), Point(0, 0, 0)}) {
    const FaceFlux f = faceFlux(a, b, c, p);
    EXPECT_EQ(f.flux, 0);
    for (const Vector& g : f.gradient) EXPECT_TRUE(g.allFinite());
  }
}

TEST(FaceFlux, OfAFaceWithoutAreaIsZero) {
  const FaceFlux f = faceFlux(kA, kB, (kA + kB) / 2, Point(0, 0, 5));
  EXPECT_NEAR(f.flux, 0, 1e-15);
  for (const Vector& g : f.gradient) EXPECT_TRUE(g.allFinite());
}

TEST(FaceFlux, FarRuleMeetsTheClosedFormWhereTheyChange) {
  const double edge = (kB - kC).norm();
  const Point p = Point(1, 2, 3).normalized() * 300 * edge;
  const FaceFlux near = faceFlux(kA, kB, kC, p);
  const FaceFlux far = faceFluxFar(kA, kB, kC, p);
  EXPECT_NEAR(near.flux, far.flux, 1e-9 * std::abs(near.flux));
  for (int k = 0; k < 3; ++k) {
    EXPECT_LT((near.gradient[k] - far.gradient[k]).norm(), 1e-9 * near.gradient[k].norm());
  }
}

TEST(FaceFlux, GradientPassesTheTaylorTest) {
  Positions corners(3, 3);
  corners << kA.transpose(), kB.transpose(), kC.transpose();
  for (const Point& p : {Point(0.6, 0.5, 2), Point(0.6, 0.5, -0.7), Point(30, 10, 3)}) {
    for (const auto rule : {&faceFlux, &faceFluxFar}) {
      const auto energy = [&](const Positions& x) {
        return rule(x.row(0).transpose(), x.row(1).transpose(), x.row(2).transpose(), p).flux;
      };
      const FaceFlux f = rule(kA, kB, kC, p);
      Positions gradient(3, 3);
      for (int k = 0; k < 3; ++k) gradient.row(k) = f.gradient[k].transpose();
      EXPECT_NEAR(test::taylorSlope(energy, corners, gradient, 1e-2), 2, 0.1) << p.transpose();
    }
  }
}

}  // namespace
}  // namespace explica::visibility
