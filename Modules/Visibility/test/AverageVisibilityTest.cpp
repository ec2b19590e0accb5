// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/AverageVisibility.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Testing/Meshes.h"
#include "Explica/Testing/Selections.h"
#include "Explica/Testing/TaylorRemainder.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

namespace explica::visibility {
namespace {

using testing::everyFace;

TEST(AverageVisibility, OfASphereAroundTheViewpointTurnedInsideOutIsOne) {
  // Every ray from the centre meets the inverted faces at right angles.
  TriangleMesh sphere = geometry::makeIcosphere(4, 2.0);
  sphere.faces.col(1).swap(sphere.faces.col(2));
  const AverageVisibility visibility(sphere.faces, everyFace(sphere), viewpoint(Point::Zero()));
  EXPECT_NEAR(visibility.value(sphere.positions), 1, 2e-3);
  EXPECT_LT(visibility.value(sphere.positions), 1);
}

TEST(AverageVisibility, OfAClosedSurfaceIsMinusTheMeanOfTwoOverR) {
  // Divergence theorem: flux = -integral of 2/r over the ball = -2 V / D for a ball at distance D.
  const TriangleMesh sphere = geometry::makeIcosphere(4, 1.0);
  const AverageVisibility visibility(sphere.faces, everyFace(sphere), viewpoint(Point(0, 0, 5)));
  EXPECT_NEAR(visibility.value(sphere.positions), -2.0 / (3 * 5), 5e-4);
}

TEST(AverageVisibility, GradientPassesTheTaylorTestForPointLineAndSurface) {
  const TriangleMesh sphere = geometry::makeFoldedSphere(2, 1.0);
  std::vector<std::int32_t> region;
  for (Eigen::Index f = 0; f < sphere.faceCount(); ++f) {
    if (sphere.corner(f, 0).z() > 0.2) region.push_back(static_cast<std::int32_t>(f));
  }
  for (const Viewpoints& from :
       {viewpoint(Point(0.3, 0.2, 3)), viewLine(Point(-1, 0, 3), Point(1, 0, 4), 4),
        viewSurface(geometry::makeRectangle(2, 2, 4, 4)), viewpoint(Point(0, 0, 1000))}) {
    Viewpoints above = from;
    for (Point& p : above.points) p.z() += 1;
    const AverageVisibility visibility(sphere.faces, region, above);
    const auto energy = [&](const Positions& x) { return visibility.value(x); };
    const VisibilityValue v = visibility.evaluate(sphere.positions);
    EXPECT_NEAR(test::taylorSlope(energy, sphere.positions, v.gradient, 1e-3), 2, 0.1);
    EXPECT_NEAR(v.value, energy(sphere.positions), 1e-14);
  }
}

TEST(AverageVisibility, GradientIsZeroOffTheRegion) {
  const TriangleMesh sphere = geometry::makeIcosphere(2);
  const AverageVisibility visibility(sphere.faces, {0, 1}, viewpoint(Point(0, 0, 9)));
  const VisibilityValue v = visibility.evaluate(sphere.positions);
  EXPECT_EQ(v.faceFlux.size(), 2);
  Eigen::Index touched = 0;
  for (Eigen::Index i = 0; i < v.gradient.rows(); ++i) touched += v.gradient.row(i).norm() > 0;
  EXPECT_LE(touched, 6);
  EXPECT_GE(touched, 3);
}

TEST(AverageVisibility, FarFromTheViewpointOnlyTheRimIsPulled) {
  // div F = 2/r vanishes: moving an inner vertex does not change the flux, only the area.
  TriangleMesh plate = geometry::makeRectangle(6, 6, 1, 1);
  const AverageVisibility visibility(plate.faces, everyFace(plate),
                                     viewpoint(Point(0.5, 0.5, 1e5)));
  const VisibilityValue v = visibility.evaluate(plate.positions);
  EXPECT_NEAR(v.value, 1, 1e-8);
  for (Eigen::Index i = 0; i < v.gradient.rows(); ++i) EXPECT_LT(v.gradient.row(i).norm(), 1e-3);
}

TEST(AverageVisibility, SurvivesFaceOrderAndRigidMotion) {
  const TriangleMesh sphere = geometry::makeFoldedSphere(2);
  const Point from(0.1, 0.2, 4);
  const double before =
      AverageVisibility(sphere.faces, {3, 4, 5, 90}, viewpoint(from)).value(sphere.positions);
  EXPECT_NEAR(
      AverageVisibility(sphere.faces, {90, 5, 4, 3}, viewpoint(from)).value(sphere.positions),
      before, 1e-14);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()).toRotationMatrix();
  const Vector shift(4, -5, 6);
  const Positions moved = (sphere.positions * turn.transpose()).rowwise() + shift.transpose();
  EXPECT_NEAR(
      AverageVisibility(sphere.faces, {3, 4, 5, 90}, viewpoint(turn * from + shift)).value(moved),
      before, 1e-13);
}

TEST(AverageVisibility, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh sphere = geometry::makeFoldedSphere(4);
  const AverageVisibility visibility(sphere.faces, everyFace(sphere), viewpoint(Point(0, 0, 4)));
  setThreadCount(1);
  const VisibilityValue one = visibility.evaluate(sphere.positions);
  setThreadCount(4);
  const VisibilityValue four = visibility.evaluate(sphere.positions);
  setThreadCount(0);
  EXPECT_EQ(one.value, four.value);
  EXPECT_EQ(one.gradient, four.gradient);
}

TEST(AverageVisibility, RefusesWhatItCannotMeasure) {
  const TriangleMesh sphere = geometry::makeIcosphere(0);
  const Viewpoints from = viewpoint(Point(0, 0, 5));
  EXPECT_THROW(AverageVisibility(sphere.faces, {}, from), InvalidInput);
  EXPECT_THROW(AverageVisibility(sphere.faces, {20}, from), InvalidInput);
  EXPECT_THROW(AverageVisibility(sphere.faces, {0}, Viewpoints{}), InvalidInput);
  const Positions collapsed = Positions::Zero(sphere.vertexCount(), 3);
  EXPECT_THROW((void)AverageVisibility(sphere.faces, {0}, from).evaluate(collapsed), InvalidInput);
}

TEST(Viewpoints, LineQuadratureIsExactForPolynomials) {
  for (int count = 1; count <= 64; ++count) {
    const Viewpoints line = viewLine(Point(0, 0, 0), Point(1, 0, 0), count);
    for (int degree = 0; degree < 2 * count; ++degree) {
      double sum = 0;
      for (std::size_t i = 0; i < line.points.size(); ++i) {
        sum += line.weights[i] * std::pow(line.points[i].x(), degree);
      }
      EXPECT_NEAR(sum, 1.0 / (degree + 1), 1e-14) << count << " points, degree " << degree;
    }
    EXPECT_TRUE(std::is_sorted(line.points.begin(), line.points.end(),
                               [](const Point& a, const Point& b) { return a.x() < b.x(); }));
  }
}

TEST(Viewpoints, WindingNumberTellsInsideFromOutside) {
  const TriangleMesh torus = geometry::makeTorus(24, 12, 3, 1);
  EXPECT_NEAR(windingNumber(torus, Point(3, 0, 0)), 1, 1e-12);
  EXPECT_NEAR(windingNumber(torus, Point(0, 0, 0)), 0, 1e-12);
  EXPECT_NEAR(windingNumber(torus, Point(9, 0, 0)), 0, 1e-12);
}

}  // namespace
}  // namespace explica::visibility
