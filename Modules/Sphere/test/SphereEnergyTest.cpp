// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sphere/SphereEnergy.h"

#include "Explica/Geometry/Fixtures.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <random>

namespace explica::sphere {
namespace {

/// A folded sphere's faces on an icosphere whose vertices are moved at random.
struct Uneven {
  SphereEnergy energy;
  Positions sphere;
};

Uneven unevenMap(const MapWeights& weights) {
  const TriangleMesh folded = geometry::makeFoldedSphere(2, 1.0);
  Positions sphere = geometry::makeIcosphere(2).positions;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> shift(-0.05, 0.05);
  for (double& x : sphere.reshaped()) x += shift(random);
  sphere.rowwise().normalize();
  return {SphereEnergy(folded.faces, restOnUnitSphere(flattening::intrinsicOf(folded)), weights),
          sphere};
}

TEST(SphereDensity, DerivativesAreThoseOfTheValue) {
  const double h = 1e-6;
  for (const MapWeights weights : {MapWeights{3, 2, 0.1}, MapWeights{.balance = 3, .corner = 0.2}})
    for (const double s : {2.5, 4.0}) {
      for (const double d : {0.4, 1.0, 2.2}) {
        const auto at = [&](double ds, double dd) {
          return sphereDensity(s + ds, d + dd, weights);
        };
        const SphereDensity psi = at(0, 0);
        EXPECT_NEAR(psi.dS, (at(h, 0).value - at(-h, 0).value) / (2 * h), 1e-8);
        EXPECT_NEAR(psi.dD, (at(0, h).value - at(0, -h).value) / (2 * h), 1e-7);
        EXPECT_NEAR(psi.dSD, (at(0, h).dS - at(0, -h).dS) / (2 * h), 1e-7);
        EXPECT_NEAR(psi.dDD, (at(0, h).dD - at(0, -h).dD) / (2 * h), 1e-6);
      }
    }
}

TEST(SphereDensity, IsLeastWhereAreasAndAnglesAreKeptAndInfiniteBeyondItsBounds) {
  EXPECT_DOUBLE_EQ(sphereDensity(2, 1, {3, kInfinity, 0}).value, 4);
  EXPECT_GT(sphereDensity(2.01, 1, {3, kInfinity, 0}).value, 4);
  EXPECT_GT(sphereDensity(2.2, 1.1, {3, kInfinity, 0}).value, 4);
  EXPECT_EQ(sphereDensity(2, 0, {3, kInfinity, 0}).value, kInfinity);
  EXPECT_EQ(sphereDensity(2, -1, {3, kInfinity, 0}).value, kInfinity);
  EXPECT_TRUE(std::isfinite(sphereDensity(8, 3.99, {3, 2, 0.1}).value));
  EXPECT_EQ(sphereDensity(8, 4, {3, 2, 0.1}).value, kInfinity);
}

TEST(SphereEnergy, GradientIsThatOfTheValue) {
  const auto [energy, sphere] = unevenMap({3, 6, 0.1});
  std::vector<TangentFrame> frames;
  for (Eigen::Index v = 0; v < sphere.rows(); ++v)
    frames.push_back(tangentFrame(sphere.row(v).transpose()));
  geometry::FaceSystem system(energy.faces(), sphere.rows());
  system.assemble([&](Eigen::Index f) { return energy.term(sphere, frames, f); });
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(-1, 1);
  Eigen::VectorXd remainders(3);
  double slope = 0;
  std::vector<Eigen::Vector2d> step;
  for (Eigen::Index v = 0; v < sphere.rows(); ++v) {
    step.emplace_back(unit(random), unit(random));
    slope += system.gradientAt(static_cast<std::int32_t>(v)).dot(step.back());
  }
  const double value = energy.value(sphere);
  for (int n = 0; n < 3; ++n) {
    const double h = 1e-3 / std::pow(4, n);
    Positions moved = sphere;
    for (Eigen::Index v = 0; v < sphere.rows(); ++v)
      moved.row(v) += h * (frames[v] * step[v]).transpose();
    moved.rowwise().normalize();
    remainders[n] = std::abs(energy.value(moved) - value - h * slope);
  }
  EXPECT_NEAR(std::log2(remainders[0] / remainders[1]) / 2, 2, 0.1);
  EXPECT_NEAR(std::log2(remainders[1] / remainders[2]) / 2, 2, 0.1);
}

TEST(SphereEnergy, FacesBendUpwards) {
  for (const double corner : {1.0, 0.1}) {
    const auto [energy, sphere] = unevenMap({.balance = 3, .corner = corner});
    std::vector<TangentFrame> frames;
    for (Eigen::Index v = 0; v < sphere.rows(); ++v)
      frames.push_back(tangentFrame(sphere.row(v).transpose()));
    for (Eigen::Index f = 0; f < energy.faces().rows(); ++f) {
      const auto term = energy.term(sphere, frames, f);
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(term.hessian);
      // What the sphere's curvature leaves is a share of its angle squared.
      EXPECT_GT(eigen.eigenvalues()[0], -0.05 * eigen.eigenvalues()[5]) << f;
    }
  }
}

TEST(SphereEnergy, LargestStepStopsShortOfTheFirstFaceTurnedOver) {
  const TriangleMesh mesh = geometry::makeIcosphere(2);
  const SphereEnergy energy(mesh.faces, restOnUnitSphere(flattening::intrinsicOf(mesh)), {});
  Positions step = Positions::Zero(mesh.vertexCount(), 3);
  const Point across = (mesh.corner(0, 1) + mesh.corner(0, 2)) / 2;
  step.row(mesh.faces(0, 0)) = 2 * (across - mesh.corner(0, 0)).transpose();
  EXPECT_NEAR(energy.largestStep(mesh.positions, step), 0.4, 0.01);
}

}  // namespace
}  // namespace explica::sphere
