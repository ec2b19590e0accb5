// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Shapes/HarmonicAnnulus.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Planar/PolygonPhantoms.h"
#include "Explica/Shapes/ShapeFit.h"
#include "Explica/Shapes/ShapeLevel.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>

namespace explica::shapes {
namespace {

/// 0 on the inner, 1 on the outer boundary: the harmonic interpolant.
HarmonicShape concentricShape(const HarmonicAnnulus& annulus) {
  HarmonicShape shape{annulus, Eigen::VectorXd::Zero(annulus.perBoundary()),
                      Eigen::VectorXd::Zero(annulus.perBoundary())};
  shape.outer[0] = 1;
  return shape;
}

HarmonicShape anyShape(int dimension, int order) {
  HarmonicShape shape =
      concentricShape({dimension, Point(1, -2, dimension == 2 ? 0 : 3), 4, 11, order});
  for (Eigen::Index k = 1; k < shape.inner.size(); ++k) {
    shape.inner[k] = 0.1 * std::sin(1.3 * k);
    shape.outer[k] = 0.1 * std::cos(0.7 * k);
  }
  return shape;
}

double at(const HarmonicShape& shape, const Point& p) {
  Positions one(1, 3);
  one.row(0) = p.transpose();
  return valuesAt(shape, one)[0];
}

TEST(HarmonicAnnulus, FunctionsAreHarmonic) {
  for (const int dimension : {2, 3}) {
    const HarmonicShape shape = anyShape(dimension, 5);
    const Point p = shape.annulus.centre + Point(4, 3, dimension == 2 ? 0 : -4);
    double before = 0;
    for (const double h : {0.2, 0.1, 0.05}) {
      double laplacian = 0;
      for (int axis = 0; axis < dimension; ++axis) {
        const Vector e = h * Vector::Unit(axis);
        laplacian += (at(shape, p + e) - 2 * at(shape, p) + at(shape, p - e)) / (h * h);
      }
      if (before != 0) {
        EXPECT_NEAR(std::log2(std::abs(before / laplacian)), 2, 0.25);
      }
      before = laplacian;
    }
    EXPECT_LT(std::abs(before), 1e-3);
  }
}

TEST(HarmonicAnnulus, ConcentricShapeIsTheExactInterpolant) {
  const HarmonicShape circle = concentricShape({2, Point::Zero(), 4, 11, 3});
  EXPECT_NEAR(at(circle, {6, 0, 0}), std::log(6.0 / 4) / std::log(11.0 / 4), 1e-14);
  const HarmonicShape sphere = concentricShape({3, Point::Zero(), 4, 11, 3});
  EXPECT_NEAR(at(sphere, {0, 6, 0}), (1 / 4.0 - 1 / 6.0) / (1 / 4.0 - 1 / 11.0), 1e-14);
}

TEST(HarmonicAnnulus, AngularFunctionsHaveMeanSquareOneAndAreOrthogonal) {
  // Trapezoid in longitude times midpoints in latitude, weighted by sin: coarse but telling.
  const HarmonicAnnulus annulus{3, Point::Zero(), 1, 2, 4};
  const Eigen::MatrixXd rows = boundarySamples(annulus, 8);
  const int samples = 8 * 4;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(25, 25);
  double total = 0;
  for (Eigen::Index s = 0; s < rows.rows(); ++s) {
    const double w = std::sin(2 * kPi * (static_cast<double>(s % (samples / 2)) + 0.5) / samples);
    gram += w * rows.row(s).transpose() * rows.row(s);
    total += w;
  }
  EXPECT_LT((gram / total - Eigen::MatrixXd::Identity(25, 25)).cwiseAbs().maxCoeff(), 0.02);
}

TEST(HarmonicAnnulus, MarginIsALowerBound) {
  HarmonicShape shape = concentricShape({2, Point::Zero(), 4, 11, 6});
  EXPECT_NEAR(boundaryMargin(shape), 0.5, 1e-12);
  shape.outer[11] = 0.45;  // cos 6 t: least value 1 - 0.45 lies between samples for other phases
  EXPECT_LE(boundaryMargin(shape), 0.05 + 1e-12);
  EXPECT_GT(boundaryMargin(shape), 0);
  shape.outer[11] = 0.55;
  EXPECT_LT(boundaryMargin(shape), 0);
}

TEST(ShapeLevel, SphereIsClosedManifoldAndExact) {
  const HarmonicShape sphere = concentricShape({3, Point(5, 6, 7), 4, 12, 2});
  const TriangleMesh mesh = levelSurface(sphere, 40);
  const double radius = 2 / (1 / 4.0 + 1 / 12.0);  // u = 1/2: 1/r is the mean of both
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    EXPECT_NEAR((mesh.positions.row(v).transpose() - Point(5, 6, 7)).norm(), radius, 1e-6);
  }
  EXPECT_EQ(mesh.vertexCount() - mesh.faceCount() / 2, 2) << "chi of a sphere";
  double volume = 0;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    volume +=
        (mesh.corner(f, 0) - Point(5, 6, 7))
            .dot((mesh.corner(f, 1) - Point(5, 6, 7)).cross(mesh.corner(f, 2) - Point(5, 6, 7))) /
        6;
  }
  EXPECT_NEAR(volume, 4.0 / 3 * kPi * radius * radius * radius, 0.01 * volume) << "outward";
}

TEST(HarmonicAnnulus, WrongInputIsRefused) {
  EXPECT_THROW(requireUsable({2, Point::Zero(), 5, 4, 3}), InvalidInput);
  EXPECT_THROW(requireUsable({4, Point::Zero(), 3, 4, 3}), InvalidInput);
  const HarmonicShape a = concentricShape({2, Point::Zero(), 3, 4, 3});
  const HarmonicShape b = concentricShape({2, Point::Zero(), 3, 5, 3});
  EXPECT_THROW((void)combine({a, b}, {1, 1}), InvalidInput);
  EXPECT_THROW((void)combine({a}, {-1}), InvalidInput);
  EXPECT_THROW((void)combine({a}, {0}), InvalidInput);
  TargetSamples outside{Positions::Zero(1, 3), Eigen::VectorXd::Ones(1)};
  outside.points(0, 0) = 6;
  EXPECT_THROW((void)fitShape({2, Point::Zero(), 3, 5, 3}, outside), InvalidInput);
}

}  // namespace
}  // namespace explica::shapes
