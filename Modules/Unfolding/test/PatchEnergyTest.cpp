// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/AreaProjection.h"
#include "../src/PatchEnergy.h"

#include "Meander.h"

#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Visibility/AverageVisibility.h"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <numeric>
#include <random>

namespace explica::unfolding {
namespace {

struct Sample {
  TriangleMesh mesh = makeMeander(6, 4, 1.2, 1);
  visibility::Viewpoints view{{Point(3, 2, 9), Point(-4, 1, 12)}, {0.25, 0.75}};
  PatchEnergy energy;
  Eigen::VectorXd multipliers;
  std::vector<std::int32_t> unknown;

  Sample() {
    std::vector<PatchFace> faces;
    const Eigen::VectorXd areas = geometry::faceAreas(mesh);
    for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
      faces.push_back({{mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)},
                       0.9 * areas[f],
                       areas[f],
                       f % 5 != 0});
    }
    std::vector<PatchSpring> springs;
    const Edges edges = geometry::buildTopology(mesh.faces, mesh.vertexCount()).edges;
    for (Eigen::Index e = 0; e < edges.rows(); ++e) {
      springs.push_back({{edges(e, 0), edges(e, 1)}, 1.1, 0.5});
    }
    energy = PatchEnergy(faces, springs);
    energy.setRoom({Vector(0.6, 0, 0.8), 40, 5});  // above all of it
    multipliers = Eigen::VectorXd::LinSpaced(mesh.faceCount(), -1, 2);
    unknown.resize(static_cast<std::size_t>(mesh.vertexCount()));
    std::iota(unknown.begin(), unknown.end(), 0);
  }

  /// The stiffness as a dense matrix, from solutions with a shifted diagonal.
  Eigen::MatrixXd stiffness(const PatchStrengths& strengths, const Eigen::VectorXd& tension) const {
    constexpr double kShift = 10;
    BlockSystem system;
    Couplings couplings;
    for (const PatchSpring& spring : energy.springs()) {
      couplings.emplace_back(std::max(spring.vertices[0], spring.vertices[1]),
                             std::min(spring.vertices[0], spring.vertices[1]));
    }
    const auto count = static_cast<std::int32_t>(mesh.vertexCount());
    system.reset(count, couplings);
    energy.addStiffness(mesh.positions, strengths, tension, unknown, system);
    system.addDiagonal(kShift);
    Eigen::MatrixXd inverse(3 * count, 3 * count);
    for (std::int32_t column = 0; column < 3 * count; ++column) {
      Positions unit = Positions::Zero(count, 3), solution;
      unit.data()[column] = 1;
      EXPECT_TRUE(system.solve(unit, solution));
      inverse.col(column) = Eigen::Map<const Eigen::VectorXd>(solution.data(), 3 * count);
    }
    return inverse.inverse() - kShift * Eigen::MatrixXd::Identity(3 * count, 3 * count);
  }
};

Positions randomDirection(Eigen::Index count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Positions d(count, 3);
  for (Eigen::Index i = 0; i < d.size(); ++i) d.data()[i] = uniform(random);
  return d;
}

/// Each term alone and all together: E(x + h d) - E(x) - h g.d must fall as h^2.
TEST(PatchEnergy, GradientOfEveryTermPassesTheTaylorTest) {
  const Sample s;
  const Positions d = randomDirection(s.mesh.vertexCount(), 3);
  for (int term = 0; term < 5; ++term) {
    const bool all = term == 4;
    const PatchStrengths strengths{term == 0 || all ? 1.3 : 0, term == 1 || all ? 4.0 : 0,
                                   term == 2 || all ? 0.7 : 0, term == 3 || all ? 2.0 : 0};
    const Eigen::VectorXd multipliers = (term == 1 || all ? 1.0 : 0.0) * s.multipliers;
    Positions gradient = Positions::Zero(s.mesh.vertexCount(), 3);
    s.energy.addGradient(s.mesh.positions, s.view, strengths, multipliers, gradient);
    const double slope = (gradient.array() * d.array()).sum();
    const auto valueAt = [&](double h) {
      return s.energy.value(s.mesh.positions + h * d, s.view, strengths, multipliers).total();
    };
    const auto remainder = [&](double h) { return std::abs(valueAt(h) - valueAt(0) - h * slope); };
    const double rate = std::log10(remainder(1e-3) / remainder(1e-4));
    EXPECT_GT(rate, 1.9) << "term " << term;
    EXPECT_LT(rate, 2.1) << "term " << term;
  }
}

TEST(PatchEnergy, StiffnessIsSymmetricPositiveSemiDefinite) {
  const Sample s;
  const Eigen::MatrixXd all = s.stiffness({1.3, 4, 0.7}, s.multipliers);
  EXPECT_NEAR((all - all.transpose()).norm(), 0, 1e-8 * all.norm());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(0.5 * (all + all.transpose()));
  EXPECT_GT(eigen.eigenvalues().minCoeff(), -1e-8 * eigen.eigenvalues().maxCoeff());
  EXPECT_GT(eigen.eigenvalues().maxCoeff(), 1);
}

TEST(PatchEnergy, StiffnessIsTheHessianWhereAreasAndLengthsAreAtRest) {
  Sample s;
  std::vector<PatchFace> faces = s.energy.faces();
  std::vector<PatchSpring> springs = s.energy.springs();
  const Eigen::VectorXd areas = geometry::faceAreas(s.mesh);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    faces[f].restArea = areas[static_cast<Eigen::Index>(f)];
  }
  const Positions& x = s.mesh.positions;
  for (PatchSpring& spring : springs) {
    spring.restLength = (x.row(spring.vertices[0]) - x.row(spring.vertices[1])).norm();
  }
  s.energy = PatchEnergy(faces, springs);
  const PatchStrengths strengths{0, 4, 0.7};
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(s.multipliers.size());
  const Eigen::MatrixXd hessian = s.stiffness(strengths, none);
  const Positions d = randomDirection(s.mesh.vertexCount(), 5);
  const Eigen::Map<const Eigen::VectorXd> flat(d.data(), d.size());
  constexpr double h = 1e-4;
  const double curvature = (s.energy.value(x + h * d, s.view, strengths, none).total() +
                            s.energy.value(x - h * d, s.view, strengths, none).total()) /
                           (h * h);
  EXPECT_NEAR(flat.dot(hessian * flat), curvature, 1e-4 * curvature);
}

TEST(PatchEnergy, LiftPullsAlongItsAxisUpToItsHeightOnly) {
  Sample s;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(s.multipliers.size());
  const PatchStrengths lift{0, 0, 0, 2};
  const auto pull = [&](double height) {
    s.energy.setRoom({Vector::UnitZ(), height, 5});
    Positions gradient = Positions::Zero(s.mesh.vertexCount(), 3);
    s.energy.addGradient(s.mesh.positions, s.view, lift, none, gradient);
    return gradient;
  };
  const double top = s.mesh.positions.col(2).maxCoeff();
  EXPECT_EQ(pull(s.mesh.positions.col(2).minCoeff()).norm(), 0);
  const Positions all = pull(top + 1);
  EXPECT_EQ(all.leftCols(2).norm(), 0);
  EXPECT_LE(all.col(2).maxCoeff(), 0);  // downhill is up
  EXPECT_LT(all.col(2).sum(), 0);
}

TEST(PatchEnergy, VisibilityTermIsAreaTimesOneLessTheAverageVisibility) {
  // The two agree where areas are at rest, up to the centroid rule for the flux.
  const TriangleMesh mesh = makeMeander(20, 6);
  std::vector<PatchFace> faces;
  std::vector<std::int32_t> all;
  const Eigen::VectorXd areas = geometry::faceAreas(mesh);
  for (std::int32_t f = 0; f < mesh.faceCount(); ++f) {
    faces.push_back(
        {{mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)}, areas[f], areas[f], true});
    all.push_back(f);
  }
  const auto view = visibility::viewpoint(Point(5, 3, 1000));
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(mesh.faceCount());
  const double term =
      PatchEnergy(faces, {}).value(mesh.positions, view, {1, 1, 1}, none).visibility;
  const double average = visibility::AverageVisibility(mesh.faces, all, view).value(mesh.positions);
  EXPECT_NEAR(term, areas.sum() * (1 - average), 1e-6 * areas.sum());
}

TEST(AreaProjection, LeavesNoFirstOrderChangeOfArea) {
  const TriangleMesh mesh = makeMeander(12, 8, 1.2, 1);
  const Eigen::VectorXd areas = geometry::faceAreas(mesh);
  std::vector<PatchFace> faces;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    faces.push_back(
        {{mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)}, areas[f], areas[f], true});
  }
  std::vector<std::int32_t> unknown(static_cast<std::size_t>(mesh.vertexCount()));
  std::iota(unknown.begin(), unknown.end(), 0);
  const Positions wanted = randomDirection(mesh.vertexCount(), 4);
  Positions velocity = wanted;
  keepAreas(PatchEnergy(faces, {}), mesh.positions, unknown, velocity);
  constexpr double h = 1e-6;
  const auto rates = [&](const Positions& v) {
    TriangleMesh moved = mesh;
    moved.positions += h * v;
    return Eigen::VectorXd((geometry::faceAreas(moved) - areas) / h);
  };
  EXPECT_GT(rates(wanted).norm(), 1);
  EXPECT_LT(rates(velocity).norm(), 1e-3);
  EXPECT_GT(velocity.norm(), 0.1 * wanted.norm());
  // A projection: what it took is orthogonal to what it left.
  EXPECT_NEAR((velocity.array() * (wanted - velocity).array()).sum(), 0,
              1e-5 * wanted.squaredNorm());
}

TEST(BlockSystem, SolvesWhatADenseSolverSolves) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-1, 1);
  constexpr std::int32_t count = 12;
  const Couplings couplings = {{3, 1}, {5, 0}, {11, 2}, {7, 3}, {10, 9}};
  BlockSystem system;
  system.reset(count, couplings);
  Eigen::MatrixXd dense = 20 * Eigen::MatrixXd::Identity(3 * count, 3 * count);
  system.addDiagonal(20);
  for (const auto& [i, j] : couplings) {
    Eigen::Matrix3d block;
    for (int n = 0; n < 9; ++n) block.data()[n] = uniform(random);
    system.add(i, j, block);
    dense.block<3, 3>(3 * i, 3 * j) += block;
    dense.block<3, 3>(3 * j, 3 * i) += block.transpose();
  }
  const Positions right = randomDirection(count, 9);
  Positions solution;
  ASSERT_TRUE(system.solve(right, solution));
  const Eigen::VectorXd expected =
      dense.ldlt().solve(Eigen::Map<const Eigen::VectorXd>(right.data(), right.size()));
  const Eigen::Map<const Eigen::VectorXd> found(solution.data(), solution.size());
  EXPECT_NEAR((found - expected).norm(), 0, 1e-12);
  system.reset(count, couplings);
  EXPECT_FALSE(system.solve(right, solution));  // all zero: not positive definite
}

}  // namespace
}  // namespace explica::unfolding
