// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/MapEnergy.h"

#include "Explica/Flattening/RimContact.h"
#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <cmath>
#include <random>

namespace explica::flattening {
namespace {

/// Slope of log remainder over log step: 2 for a gradient, 3 with a Hessian.
double slopeOf(const std::vector<double>& remainders, double ratio) {
  return std::log(remainders.front() / remainders.back()) /
         (std::log(ratio) * static_cast<double>(remainders.size() - 1));
}

struct Bent {
  IntrinsicMesh mesh;
  FlatPositions flat, way;
};

/// A map with strain of all kinds, and a direction.
Bent bentMap() {
  const TriangleMesh mesh = geometry::makeRectangle(4, 3, 4, 3);
  Bent bent{intrinsicOf(mesh), mesh.positions.leftCols<2>(), {}};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  bent.way.resize(bent.flat.rows(), 2);
  for (Eigen::Index v = 0; v < bent.flat.rows(); ++v) {
    bent.flat.row(v) += 0.2 * Eigen::RowVector2d(uniform(random), uniform(random));
    bent.way.row(v) << uniform(random), uniform(random);
  }
  return bent;
}

TEST(MapEnergy, GradientAndHessianPassTheTaylorTest) {
  const Bent bent = bentMap();
  const MapEnergy energy(bent.mesh, 0.7, 1e-6);
  const FlatPositions gradient = energy.gradient(bent.flat);
  double slope = 0, curvature = 0;
  for (Eigen::Index v = 0; v < bent.flat.rows(); ++v) slope += gradient.row(v).dot(bent.way.row(v));
  for (Eigen::Index f = 0; f < bent.mesh.faces.rows(); ++f) {
    Eigen::Matrix<double, 6, 1> way;
    for (int k = 0; k < 3; ++k) {
      way.segment<2>(2 * k) = bent.way.row(bent.mesh.faces(f, k)).transpose();
    }
    curvature += way.dot(energy.faceTerm(bent.flat, f, false).hessian * way);
  }
  std::vector<double> first, second;
  const double start = energy.value(bent.flat);
  // Areas within 0.006 count as kept: steps must be small beside that.
  for (double step = 4e-4; step > 4e-5; step /= 2) {
    const double change = energy.value(bent.flat + step * bent.way) - start;
    first.push_back(std::abs(change - step * slope));
    second.push_back(std::abs(change - step * slope - step * step * curvature / 2));
  }
  EXPECT_NEAR(slopeOf(first, 2), 2, 0.1);
  EXPECT_NEAR(slopeOf(second, 2), 3, 0.25);
}

TEST(MapEnergy, TheConvexHessianHasNoNegativeEigenvalueAndIsTheWholeOneNearRest) {
  const Bent bent = bentMap();
  const MapEnergy energy(bent.mesh, 0.7, 1e-6);
  for (Eigen::Index f = 0; f < bent.mesh.faces.rows(); ++f) {
    // Lifted by so little that only a negative eigenvalue leaves a negative pivot.
    Eigen::MatrixXd hessian = energy.faceTerm(bent.flat, f, true).hessian;
    hessian.diagonal().array() += 1e-12 * hessian.norm();
    EXPECT_GT(Eigen::LDLT<Eigen::MatrixXd>(hessian).vectorD().minCoeff(), 0);
  }
  // Slightly stretched, |J - R|^2 is convex and nothing is taken away.
  const FlatPositions stretched =
      1.002 * geometry::makeRectangle(4, 3, 4, 3).positions.leftCols<2>();
  const auto whole = energy.faceTerm(stretched, 0, false).hessian;
  EXPECT_LT((energy.faceTerm(stretched, 0, true).hessian - whole).norm(), 1e-12 * whole.norm());
}

TEST(MapEnergy, IsZeroForRigidMotionsAndInfiniteForMirrorImages) {
  const Bent bent = bentMap();
  const MapEnergy energy(bent.mesh, 0.7, 1e-6);
  Eigen::Matrix2d turn;
  turn << std::cos(1.0), -std::sin(1.0), std::sin(1.0), std::cos(1.0);
  FlatPositions moved =
      geometry::makeRectangle(4, 3, 4, 3).positions.leftCols<2>() * turn.transpose();
  moved.rowwise() += Eigen::RowVector2d(5, -3);
  EXPECT_NEAR(energy.value(moved), 0, 1e-12);
  moved.col(0) *= -1;
  EXPECT_EQ(energy.value(moved), kInfinity);
}

TEST(MapEnergy, KnowsTheEnergyOfAStretch) {
  const Bent bent = bentMap();
  const MapEnergy energy(bent.mesh, 0.7, 1e-6);
  FlatPositions flat = geometry::makeRectangle(4, 3, 4, 3).positions.leftCols<2>();
  flat.col(0) *= 1.5;
  flat.col(1) *= 0.8;
  // Singular values 1.5 and 0.8: |J - R|^2 = 0.25 + 0.04, D = 1.2.
  const double expected =
      0.29 + 2 * (1.2 + 1 / 1.2 - 2) + 0.7 * (std::sqrt(0.006 * 0.006 + 0.2 * 0.2) - 0.006);
  EXPECT_NEAR(energy.value(flat), expected, 1e-12);
}

TEST(MapEnergy, TheLargestStepStopsBeforeTheFirstFaceVanishes) {
  const TriangleMesh mesh = geometry::makeRectangle(1, 1, 1, 1);
  const MapEnergy energy(intrinsicOf(mesh), 1, 1e-6);
  const FlatPositions flat = mesh.positions.leftCols<2>();
  FlatPositions step = FlatPositions::Zero(4, 2);
  step.col(0) = -2 * flat.col(0);  // x shrinks to nothing at half the step
  EXPECT_NEAR(energy.largestStep(flat, step), 0.4, 1e-12);
  step.col(0) = 2 * flat.col(0);
  EXPECT_EQ(energy.largestStep(flat, step), 1);
}

TEST(RimContact, GradientPassesTheTaylorTestAndStepsEndBeforeContact) {
  // A rim that nearly meets itself: vertex 4 above the edge from 0 to 1.
  const Loop rim = {0, 1, 2, 3, 4};
  FlatPositions flat(5, 2), way(5, 2);
  flat << 0, 0, 4, 0, 4, 4, 2, 4, 2, 0.3;
  way << 0.1, 0.4, 0.2, -0.1, 0, 0, 0.3, 0, 0.2, -0.5;
  const RimContact contact(rim, {4, 4, 4, 4, 4}, 1);
  ASSERT_EQ(contact.near(flat).size(), 1U);
  const auto term = contact.term(flat, contact.near(flat).front());
  double slope = 0;
  for (int k = 0; k < 3; ++k) {
    slope += way.row(term.vertices[k]).dot(term.gradient.segment<2>(2 * k).transpose());
  }
  std::vector<double> remainders;
  for (double step = 1e-3; step > 1e-4; step /= 2) {
    remainders.push_back(
        std::abs(contact.value(flat + step * way) - contact.value(flat) - step * slope));
  }
  EXPECT_NEAR(slopeOf(remainders, 2), 2, 0.1);

  FlatPositions fall = FlatPositions::Zero(5, 2);
  fall(4, 1) = -0.6;  // meets the edge at half the step
  EXPECT_NEAR(contact.largestStep(flat, fall), 0.4, 1e-9);
  fall(4, 1) = 0.6;
  EXPECT_EQ(contact.largestStep(flat, fall), 1);
}

}  // namespace
}  // namespace explica::flattening
