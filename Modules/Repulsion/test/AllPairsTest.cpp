// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Repulsion/AllPairs.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Testing/Meshes.h"
#include "Explica/Testing/Selections.h"
#include "Explica/Testing/TaylorRemainder.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>

namespace explica::repulsion {
namespace {

using testing::everyVertex;

double energyOf(const TriangleMesh& mesh) {
  return AllPairs(mesh, everyVertex(mesh)).value(mesh.positions);
}

TEST(AllPairs, OfConcentricSpheresIsTheKnownIntegral) {
  const double a = 1;
  const double b = 1.7;
  // Both orders of every pair: 2 * 8 pi^2 a b ln((b + a) / (b - a)).
  const double exact = 16 * kPi * kPi * a * b * std::log((b + a) / (b - a));
  std::array<double, 2> error{};
  for (int level = 1; level <= 2; ++level) {
    const TriangleMesh inner = geometry::makeIcosphere(level, a);
    const TriangleMesh outer = geometry::makeIcosphere(level, b);
    const double between =
        energyOf(geometry::joined(inner, outer)) - energyOf(inner) - energyOf(outer);
    error[static_cast<std::size_t>(level - 1)] = std::abs(between / exact - 1);
  }
  EXPECT_LT(error[1], 0.05);
  EXPECT_NEAR(std::log2(error[0] / error[1]), 2, 0.3);
}

TEST(AllPairs, GradientPassesTheTaylorTest) {
  const TriangleMesh mesh = geometry::makeFoldedSphere(1, 1.0, 0.2, 3);
  const AllPairs knot(mesh, everyVertex(mesh));
  const auto energy = [&](const Positions& x) { return knot.value(x); };
  const KnotValue v = knot.evaluate(mesh.positions);
  EXPECT_NEAR(test::taylorSlope(energy, mesh.positions, v.gradient, 1e-4), 2, 0.15);
}

TEST(AllPairs, CountsPairsOfMovingAndFixedFacesBothWays) {
  // What moves decides which constant is left out, never the differences or the gradient.
  const TriangleMesh mesh = geometry::makeIcosphere(1);
  std::vector<bool> some(static_cast<std::size_t>(mesh.vertexCount()), false);
  some[0] = some[5] = some[11] = true;
  Positions moved = mesh.positions;
  for (const int v : {0, 5, 11}) moved.row(v) *= 1.05;
  const AllPairs whole(mesh, everyVertex(mesh));
  const AllPairs part(mesh, some);
  const KnotValue wholeValue = whole.evaluate(moved);
  const KnotValue partValue = part.evaluate(moved);
  EXPECT_NEAR(partValue.value - part.value(mesh.positions),
              wholeValue.value - whole.value(mesh.positions), 1e-9);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    if (some[static_cast<std::size_t>(v)]) {
      EXPECT_LT((partValue.gradient.row(v) - wholeValue.gradient.row(v)).norm(), 1e-10);
    } else {
      EXPECT_EQ(partValue.gradient.row(v).norm(), 0);
    }
  }
}

TEST(AllPairs, GradientHasNoNetForceAndNoNetTorque) {
  const TriangleMesh mesh = geometry::makeFoldedSphere(1);
  const KnotValue v = AllPairs(mesh, everyVertex(mesh)).evaluate(mesh.positions);
  EXPECT_LT(v.gradient.colwise().sum().norm(), 1e-4 * v.gradient.norm());
  Vector torque = Vector::Zero();
  for (Eigen::Index i = 0; i < mesh.vertexCount(); ++i) {
    torque += Vector(mesh.positions.row(i)).cross(Vector(v.gradient.row(i)));
  }
  EXPECT_LT(torque.norm(), 1e-4 * v.gradient.norm());
}

TEST(AllPairs, FollowsEulersIdentityForItsDegreeTwo) {
  // E(s x) = s^2 E(x) gives x . grad E = 2 E.
  const TriangleMesh mesh = geometry::makeFoldedSphere(1);
  const KnotValue v = AllPairs(mesh, everyVertex(mesh)).evaluate(mesh.positions);
  EXPECT_NEAR((v.gradient.array() * mesh.positions.array()).sum(), 2 * v.value, 1e-9 * v.value);
  TriangleMesh twice = mesh;
  twice.positions *= 2;
  EXPECT_DOUBLE_EQ(energyOf(twice), 4 * v.value);
}

TEST(AllPairs, DescentOnTheEnergyNeedsTheMinusSign) {
  // Erratum 3: a step along -grad separates two sheets, a step along +grad brings them closer.
  TriangleMesh lower = geometry::makeRectangle(3, 3, 1, 1);
  TriangleMesh upper = lower;
  upper.positions.col(2).array() += 0.2;
  const TriangleMesh sheets = geometry::joined(lower, upper);
  const AllPairs knot(sheets, everyVertex(sheets));
  const KnotValue v = knot.evaluate(sheets.positions);
  const double step = 1e-3 / v.gradient.norm();
  const auto gap = [&](const Positions& x) {
    return x.bottomRows(upper.vertexCount()).col(2).mean() -
           x.topRows(lower.vertexCount()).col(2).mean();
  };
  EXPECT_GT(gap(sheets.positions - step * v.gradient), 0.2);
  EXPECT_LT(gap(sheets.positions + step * v.gradient), 0.2);
  EXPECT_LT(knot.value(sheets.positions - step * v.gradient), v.value);
}

TEST(AllPairs, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh mesh = geometry::makeIcosphere(2);
  const AllPairs knot(mesh, everyVertex(mesh));
  setThreadCount(1);
  const KnotValue one = knot.evaluate(mesh.positions);
  setThreadCount(4);
  const KnotValue four = knot.evaluate(mesh.positions);
  setThreadCount(0);
  EXPECT_EQ(one.value, four.value);
  EXPECT_EQ(one.gradient, four.gradient);
}

TEST(AllPairs, RefusesWhatHasNoEnergy) {
  TriangleMesh mesh = geometry::makeIcosphere(0);
  EXPECT_THROW(AllPairs(mesh, std::vector<bool>(3)), InvalidInput);
  mesh.faces.row(1) = mesh.faces.row(0);
  EXPECT_THROW(AllPairs(mesh, everyVertex(mesh)), InvalidInput);
  mesh = geometry::makeIcosphere(0);
  mesh.faces(0, 1) = 99;
  EXPECT_THROW(AllPairs(mesh, everyVertex(mesh)), InvalidInput);
  mesh.faces(0, 1) = mesh.faces(0, 0);
  EXPECT_THROW(AllPairs(mesh, everyVertex(mesh)), InvalidInput);
}

}  // namespace
}  // namespace explica::repulsion
