// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Shapes/ShapeFit.h"

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Shapes/ShapeLevel.h"
#include "Explica/Testing/Curves.h"
#include "Lobed.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <map>
#include <numeric>
#include <random>

namespace explica::shapes {
namespace {

/// A smooth closed surface with lobes about the coordinate axes.
TriangleMesh lobedSurface(double depth, double twist) {
  TriangleMesh mesh = geometry::makeIcosphere(4);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const Vector d = mesh.positions.row(v).transpose().normalized();
    const double x = std::cos(twist) * d.x() + std::sin(twist) * d.y();
    const double y = -std::sin(twist) * d.x() + std::cos(twist) * d.y();
    const double r = 30 * (1 + depth * (x * x * x * x + y * y * y * y + std::pow(d.z(), 4) - 0.6));
    mesh.positions.row(v) = r * d.transpose();
  }
  return mesh;
}

HarmonicAnnulus planeAnnulus() {
  return {2, Point::Zero(), 12.5, 29, 64};
}

int componentsOf(const TriangleMesh& mesh) {
  std::vector<std::int32_t> parent(static_cast<std::size_t>(mesh.vertexCount()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    parent[root(mesh.faces(f, 0))] = root(mesh.faces(f, 1));
    parent[root(mesh.faces(f, 1))] = root(mesh.faces(f, 2));
  }
  int count = 0;
  for (std::size_t v = 0; v < parent.size(); ++v) {
    count += parent[v] == static_cast<std::int32_t>(v);
  }
  return count;
}

TEST(ShapeFit, OfACurveIsWithinHalfAVoxel) {
  for (const planar::Curve& target : {lobed(3, 0.2, 0.4), lobed(5, 0.08, 1), lobed(2, 0.25, 0)}) {
    const ShapeFit fit = fitShape(planeAnnulus(), samplesOf(target, 600));
    const std::vector<planar::Curve> curves = levelCurves(fit.shape, 200);
    ASSERT_EQ(curves.size(), 1U);
    const double voxel = 58.0 / 199;
    EXPECT_LT(distanceBetween(curves[0], target).max, 0.5 * voxel);
    EXPECT_LT(distanceBetween(target, curves[0]).max, 0.5 * voxel);
    EXPECT_GT(boundaryMargin(fit.shape), 0);
    EXPECT_LT(fit.history.back().symmetricDifference,
              0.02 * fit.history.front().symmetricDifference);
  }
}

TEST(ShapeFit, SymmetricDifferenceNeverRisesMuch) {
  const ShapeFit fit = fitShape(planeAnnulus(), samplesOf(lobed(3, 0.2, 0.4), 600));
  for (std::size_t k = 1; k < fit.history.size(); ++k) {
    EXPECT_LT(fit.history[k].symmetricDifference,
              1.05 * fit.history[k - 1].symmetricDifference + 0.05);
  }
}

TEST(ShapeFit, OfASurfaceIsWithinHalfAVoxelOfA96Grid) {
  const TriangleMesh target = lobedSurface(0.3, 0);
  const HarmonicAnnulus annulus{3, Point::Zero(), 23.5, 38.5, 14};
  const ShapeFit fit = fitShape(annulus, samplesOf(target, 2000));
  const TriangleMesh mesh = levelSurface(fit.shape, 96);
  EXPECT_EQ(componentsOf(mesh), 1);
  EXPECT_EQ(mesh.vertexCount() - mesh.faceCount() / 2, 2);
  const double voxel = 77.0 / 95;
  EXPECT_LT(distanceBetween(mesh, target).max, 0.5 * voxel);
  EXPECT_LT(distanceBetween(target, mesh).max, 0.5 * voxel);
}

TEST(ShapeFit, EveryConvexCombinationOfCurvesIsOneClosedCurve) {
  std::vector<HarmonicShape> shapes;
  for (const planar::Curve& target :
       {lobed(3, 0.2, 0.4), lobed(5, 0.08, 1), lobed(2, 0.25, 0), lobed(4, 0.15, 2)}) {
    shapes.push_back(fitShape(planeAnnulus(), samplesOf(target, 500)).shape);
  }
  std::mt19937 random(5);
  std::exponential_distribution<double> weight(1);
  for (int trial = 0; trial < 30; ++trial) {
    std::vector<double> weights(shapes.size());
    for (double& w : weights) w = weight(random);
    const HarmonicShape mixed = combine(shapes, weights);
    EXPECT_GT(boundaryMargin(mixed), 0) << "seed 5, trial " << trial;
    const std::vector<planar::Curve> curves = levelCurves(mixed, 80);
    ASSERT_EQ(curves.size(), 1U) << "seed 5, trial " << trial;
    EXPECT_TRUE(planar::intersectingEdges(curves[0]).empty());
  }
}

TEST(ShapeFit, EveryConvexCombinationOfSurfacesIsOneClosedSurface) {
  const HarmonicAnnulus annulus{3, Point::Zero(), 21, 41, 10};
  std::vector<HarmonicShape> shapes;
  for (const auto& [depth, twist] : {std::pair{0.3, 0.0}, {0.3, 0.7}, {-0.2, 0.3}}) {
    shapes.push_back(fitShape(annulus, samplesOf(lobedSurface(depth, twist), 1500)).shape);
  }
  std::mt19937 random(9);
  std::exponential_distribution<double> weight(1);
  for (int trial = 0; trial < 6; ++trial) {
    std::vector<double> weights(shapes.size());
    for (double& w : weights) w = weight(random);
    const HarmonicShape mixed = combine(shapes, weights);
    EXPECT_GT(boundaryMargin(mixed), 0);
    const TriangleMesh mesh = levelSurface(mixed, 28);
    EXPECT_EQ(componentsOf(mesh), 1) << "seed 9, trial " << trial;
    // Closed: every directed edge has its opposite, once.
    std::map<std::pair<int, int>, int> edges;
    for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
      for (int k = 0; k < 3; ++k) ++edges[{mesh.faces(f, k), mesh.faces(f, (k + 1) % 3)}];
    }
    for (const auto& [edge, count] : edges) {
      ASSERT_EQ(count, 1);
      ASSERT_EQ((edges.count({edge.second, edge.first})), 1U);
    }
  }
}

/// Distances of a curve's vertices from the origin.
std::pair<double, double> radiiOf(const planar::Curve& curve) {
  const Eigen::VectorXd r = curve.positions.rowwise().norm();
  return {r.minCoeff(), r.maxCoeff()};
}

TEST(ShapeFit, TheAverageOfTwoCirclesIsTheCircleOfTheirGeometricMean) {
  for (const auto& [a, b] : {std::pair{18.0, 22.0}, {15.0, 25.0}}) {
    std::vector<HarmonicShape> shapes;
    for (const double r : {a, b}) {
      shapes.push_back(fitShape(planeAnnulus(), samplesOf(planar::makeCircle(400, r), 600)).shape);
    }
    const auto curves = levelCurves(combine(shapes, {1, 1}), 200);
    ASSERT_EQ(curves.size(), 1U);
    const auto [low, high] = radiiOf(curves[0]);
    EXPECT_NEAR(low, std::sqrt(a * b), 0.02);
    EXPECT_NEAR(high, std::sqrt(a * b), 0.02);
  }
}

TEST(ShapeFit, TheAverageOfTwoSpheresIsTheSphereOfTheirHarmonicMean) {
  const HarmonicAnnulus annulus{3, Point::Zero(), 12, 30, 10};
  std::vector<HarmonicShape> shapes;
  for (const double r : {18.0, 22.0}) {
    TriangleMesh sphere = geometry::makeIcosphere(4);
    sphere.positions *= r / sphere.positions.row(0).norm();
    shapes.push_back(fitShape(annulus, samplesOf(sphere, 1500)).shape);
  }
  const TriangleMesh mesh = levelSurface(combine(shapes, {1, 1}), 40);
  const Eigen::VectorXd r = mesh.positions.rowwise().norm();
  // The icosphere's faces lie up to 0.03 mm within the sphere.
  EXPECT_NEAR(r.minCoeff(), 2 / (1 / 18.0 + 1 / 22.0), 0.06);
  EXPECT_NEAR(r.maxCoeff(), 2 / (1 / 18.0 + 1 / 22.0), 0.06);
}

TEST(ShapeFit, ACurveAndItsMirrorImageAverageToAMirrorSymmetricCurve) {
  const planar::Curve target = lobed(3, 0.2, 0.4);
  planar::Curve mirrored = target;
  mirrored.positions.col(1) *= -1;
  mirrored.positions = Positions2(mirrored.positions.colwise().reverse());
  const HarmonicShape average = combine({fitShape(planeAnnulus(), samplesOf(target, 600)).shape,
                                         fitShape(planeAnnulus(), samplesOf(mirrored, 600)).shape},
                                        {1, 1});
  // Coefficients of sines: 2, 4, ...
  for (Eigen::Index k = 2; k < average.inner.size(); k += 2) {
    EXPECT_NEAR(average.inner[k], 0, 1e-3) << k;
    EXPECT_NEAR(average.outer[k], 0, 1e-3) << k;
  }
  for (const planar::Curve& curve : levelCurves(average, 200)) {
    planar::Curve other = curve;
    other.positions.col(1) *= -1;
    EXPECT_LT(distanceBetween(other, curve).max, 0.02);
  }
}

TEST(ShapeFit, ATurnedTargetHasTheTurnedShapeWhateverItsSampling) {
  const double turn = 0.7123;
  const HarmonicShape straight = fitShape(planeAnnulus(), samplesOf(lobed(3, 0.2, 0), 600)).shape;
  // radius 20 (1 + depth cos(3 t + phase)): turned by -phase / 3.
  for (const int samples : {450, 1000}) {
    const HarmonicShape turned =
        fitShape(planeAnnulus(), samplesOf(lobed(3, 0.2, -3 * turn), samples)).shape;
    for (int n = 1; n <= 12; ++n) {
      const Eigen::Index c = 2 * n - 1;
      const double cosine = std::cos(n * turn), sine = std::sin(n * turn);
      for (const auto part : {&HarmonicShape::inner, &HarmonicShape::outer}) {
        const Eigen::VectorXd &a = straight.*part, &b = turned.*part;
        EXPECT_NEAR(b[c], cosine * a[c] - sine * a[c + 1], 4e-3) << n << ' ' << samples;
        EXPECT_NEAR(b[c + 1], sine * a[c] + cosine * a[c + 1], 4e-3) << n << ' ' << samples;
      }
    }
  }
}

TEST(ShapeFit, DoesNotHangOnTheStart) {
  ShapeFitOptions options;
  for (const planar::Curve& target : {lobed(3, 0.2, 0.4), lobed(2, 0.25, 1)}) {
    const HarmonicShape middle = fitShape(planeAnnulus(), samplesOf(target, 600)).shape;
    for (const double start : {0.05, 0.9}) {
      options.start = start;
      const ShapeFit fit = fitShape(planeAnnulus(), samplesOf(target, 600), options);
      EXPECT_LT((fit.shape.inner - middle.inner).cwiseAbs().maxCoeff(), 2e-3) << start;
      EXPECT_LT((fit.shape.outer - middle.outer).cwiseAbs().maxCoeff(), 2e-3) << start;
      EXPECT_LT(distanceBetween(levelCurves(fit.shape, 200)[0], levelCurves(middle, 200)[0]).max,
                0.005);
    }
  }
  options.start = 1;
  EXPECT_THROW((void)fitShape(planeAnnulus(), samplesOf(lobed(3, 0.2, 0), 300), options),
               InvalidInput);
}

TEST(ShapeFit, OfATurnedSurfaceIsTheTurnedFitWhateverTheStart) {
  const HarmonicAnnulus annulus{3, Point::Zero(), 23.5, 38.5, 8};
  const TriangleMesh target = lobedSurface(0.3, 0);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.8, Vector(1, 2, 3).normalized()).toRotationMatrix();
  TriangleMesh turned = target;
  turned.positions = target.positions * turn.transpose();
  const HarmonicShape straight = fitShape(annulus, samplesOf(target, 1500)).shape;
  ShapeFitOptions options;
  options.start = 0.2;
  for (const int samples : {2500}) {
    const HarmonicShape other = fitShape(annulus, samplesOf(turned, samples), options).shape;
    TriangleMesh expected = levelSurface(straight, 48);
    expected.positions = expected.positions * turn.transpose();
    // Off the level too: averages with a sphere are turned alike.
    const HarmonicShape sphere{annulus, Eigen::VectorXd::Zero(annulus.perBoundary()),
                               Eigen::VectorXd::Unit(annulus.perBoundary(), 0)};
    TriangleMesh mixed = levelSurface(combine({straight, sphere}, {1, 1}), 48);
    mixed.positions = mixed.positions * turn.transpose();
    EXPECT_LT(distanceBetween(levelSurface(other, 48), expected).max, 0.15) << samples;
    EXPECT_LT(distanceBetween(levelSurface(combine({other, sphere}, {1, 1}), 48), mixed).max, 0.15)
        << samples;
  }
}

TEST(ShapeFit, CombinationAtACornerIsThatShape) {
  const HarmonicShape a = fitShape(planeAnnulus(), samplesOf(lobed(3, 0.2, 0), 300)).shape;
  const HarmonicShape b = fitShape(planeAnnulus(), samplesOf(lobed(4, 0.15, 0), 300)).shape;
  EXPECT_LT((combine({a, b}, {2, 0}).inner - a.inner).norm(), 1e-12);
  const HarmonicShape average = combine({a, b}, {1, 1});
  EXPECT_LT((average.outer - 0.5 * (a.outer + b.outer)).norm(), 1e-12);
}

}  // namespace
}  // namespace explica::shapes
