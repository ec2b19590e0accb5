// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/FluxVariance.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Testing/Meshes.h"
#include "Explica/Testing/Selections.h"
#include "Explica/Visibility/VisibleFraction.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::visibility {
namespace {

using testing::everyFace;

TEST(FluxVariance, OfASphereFromFarIsAThird) {
  // f = cos: its mean over the sphere is 0, that of its square 1/3.
  const TriangleMesh sphere = geometry::makeIcosphere(5);
  EXPECT_NEAR(fluxVariance(sphere, everyFace(sphere), viewpoint(Point(0, 0, 1e5))), 1.0 / 3, 1e-3);
}

TEST(FluxVariance, IsNothingOnAPlateSeenFromFarAtAnyAngle) {
  const TriangleMesh plate = geometry::makeRectangle(4, 3, 2, 1);
  for (const Point& from : {Point(0, 0, 1e6), Point(1e6, 0, 1e6), Point(0, 3e6, -1e6)}) {
    EXPECT_LT(fluxVariance(plate, everyFace(plate), viewpoint(from)), 1e-10);
  }
}

TEST(FluxVariance, OfADiscFromNearIsItsClosedForm) {
  // On a disc of radius a at distance h: integral of h^2 / (h^2 + r^2) is pi h^2 ln(1 + a^2/h^2),
  // that of h / sqrt(h^2 + r^2) is 2 pi h (sqrt(h^2 + a^2) - h).
  const int n = 2000;
  TriangleMesh disc;
  disc.positions.setZero(n + 1, 3);
  disc.faces.resize(n, 3);
  for (int k = 0; k < n; ++k) {
    const double t = 2 * kPi * k / n;
    disc.positions.row(k) << std::cos(t), std::sin(t), 0;
    disc.faces.row(k) << n, k, (k + 1) % n;
  }
  for (const double h : {0.2, 1.0, 5.0}) {
    const double mean = 2 * h * (std::sqrt(h * h + 1) - h);
    const double square = h * h * std::log1p(1 / (h * h));
    EXPECT_NEAR(fluxVariance(disc, everyFace(disc), viewpoint(Point(0, 0, h))),
                square - mean * mean, 1e-5);
  }
}

TEST(FluxVariance, OfSeveralViewpointsIsTheirWeightedMean) {
  const TriangleMesh sphere = geometry::makeIcosphere(2);
  const auto faces = everyFace(sphere);
  const Point a(0, 0, 3), b(5, 1, 0);
  const double both = fluxVariance(sphere, faces, viewpoints({a, b}, {1, 3}));
  EXPECT_NEAR(both,
              0.25 * fluxVariance(sphere, faces, viewpoint(a)) +
                  0.75 * fluxVariance(sphere, faces, viewpoint(b)),
              1e-12);
  EXPECT_THROW((void)fluxVariance(sphere, {}, viewpoint(a)), InvalidInput);
}

TEST(RealVisibility, OfASphereFromFarIsAQuarter) {
  // Its shadow, pi R^2, over its area.
  const TriangleMesh sphere = geometry::makeIcosphere(5);
  const VisibleFraction seen = visibleFraction(sphere, viewpoint(Point(0, 1e5, 0)));
  EXPECT_NEAR(seen.realOf(sphere, everyFace(sphere)), 0.25, 1e-3);
  EXPECT_LE((seen.arriving - seen.face).maxCoeff(), 1e-12);
}

TEST(Viewpoints, SeveralAreWeighted) {
  const Viewpoints equal = viewpoints({Point(1, 0, 0), Point(0, 1, 0)});
  EXPECT_EQ(equal.weights, (std::vector<double>{0.5, 0.5}));
  const Viewpoints given = viewpoints({Point(1, 0, 0), Point(0, 1, 0)}, {6, 2});
  EXPECT_EQ(given.weights, (std::vector<double>{0.75, 0.25}));
  EXPECT_THROW((void)viewpoints({}), InvalidInput);
  EXPECT_THROW((void)viewpoints({Point(1, 0, 0)}, {1, 2}), InvalidInput);
  EXPECT_THROW((void)viewpoints({Point(1, 0, 0)}, {-1}), InvalidInput);
  EXPECT_THROW((void)viewpoints({Point(kNaN, 0, 0)}), InvalidInput);
}

}  // namespace
}  // namespace explica::visibility
