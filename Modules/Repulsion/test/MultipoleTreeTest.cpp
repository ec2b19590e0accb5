// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Repulsion/MultipoleTree.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Repulsion/AllPairs.h"
#include "Explica/Testing/InstructionSets.h"
#include "Explica/Testing/Meshes.h"
#include "Explica/Testing/Selections.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>

namespace explica::repulsion {
namespace {

using testing::everyVertex;

std::vector<bool> cap(const TriangleMesh& mesh, double z) {
  std::vector<bool> moves(static_cast<std::size_t>(mesh.vertexCount()));
  for (std::size_t v = 0; v < moves.size(); ++v) {
    moves[v] = mesh.positions(static_cast<Eigen::Index>(v), 2) > z;
  }
  return moves;
}

void expectClose(const TriangleMesh& mesh, const std::vector<bool>& moves, double tolerance) {
  const KnotValue exact = AllPairs(mesh, moves).evaluate(mesh.positions);
  const MultipoleTree tree(mesh, moves);
  const KnotValue fast = tree.evaluate(mesh.positions);
  EXPECT_NEAR(fast.value, exact.value, tolerance * exact.value);
  EXPECT_LT((fast.gradient - exact.gradient).norm(), tolerance * exact.gradient.norm());
}

TEST(MultipoleTree, AgreesWithAllPairsOnClosedSurfaces) {
  const TriangleMesh sphere = geometry::makeIcosphere(2);
  expectClose(sphere, everyVertex(sphere), 1e-3);
  const TriangleMesh folded = geometry::makeFoldedSphere(2);
  expectClose(folded, everyVertex(folded), 1e-3);
}

TEST(MultipoleTree, AgreesWithAllPairsWhereSomeFacesAreFixed) {
  const TriangleMesh folded = geometry::makeFoldedSphere(3);
  expectClose(folded, cap(folded, 0.6), 1e-3);
}

TEST(MultipoleTree, AgreesWithAllPairsForNeedlesAndSheetsThatAlmostTouch) {
  TriangleMesh lower = geometry::makeRectangle(6, 2, 1, 1);
  TriangleMesh upper = geometry::makeRectangle(2, 4, 1, 1);
  TriangleMesh sheets;
  sheets.positions.resize(lower.vertexCount() + upper.vertexCount(), 3);
  upper.positions.col(2).array() += 0.1;
  sheets.positions << lower.positions, upper.positions;
  sheets.faces.resize(lower.faceCount() + upper.faceCount(), 3);
  sheets.faces << lower.faces,
      (upper.faces.array() + static_cast<std::int32_t>(lower.vertexCount())).matrix();
  expectClose(sheets, everyVertex(sheets), 2e-3);
}

TEST(MultipoleTree, ErrorFallsWithTheOpening) {
  const TriangleMesh sphere = geometry::makeIcosphere(3);
  std::vector<bool> moves(static_cast<std::size_t>(sphere.vertexCount()), false);
  for (std::size_t v = 0; v < moves.size(); v += 20) moves[v] = true;
  const KnotValue exact = AllPairs(sphere, moves).evaluate(sphere.positions);
  const auto error = [&](double opening) {
    MultipoleTreeOptions options;
    options.opening = opening;
    options.nearRatio = 1.3;  // so that near pairs do not hide it
    const KnotValue v = MultipoleTree(sphere, moves, options).evaluate(sphere.positions);
    return (v.gradient - exact.gradient).norm() / exact.gradient.norm();
  };
  const double coarse = error(0.8);
  EXPECT_LT(error(0.3), 0.5 * coarse);
  EXPECT_LT(error(0.3), 1e-3);
}

TEST(MultipoleTree, ErrorFallsWithTheNearRatio) {
  const TriangleMesh sphere = geometry::makeIcosphere(3);
  const KnotValue exact = AllPairs(sphere, everyVertex(sphere)).evaluate(sphere.positions);
  const auto error = [&](double nearRatio) {
    const KnotValue v =
        MultipoleTree(sphere, everyVertex(sphere), {0.25, nearRatio}).evaluate(sphere.positions);
    return (v.gradient - exact.gradient).norm() / exact.gradient.norm();
  };
  EXPECT_LT(error(2), 0.6 * error(1));
  EXPECT_LT(error(MultipoleTreeOptions().nearRatio), 2e-3);
}

TEST(MultipoleTree, GivesTheSameWhenItsMemoryIsUsedAgain) {
  const TriangleMesh folded = geometry::makeFoldedSphere(3);
  const MultipoleTree tree(folded, cap(folded, 0.3));
  const KnotValue first = tree.evaluate(folded.positions);
  Positions moved = folded.positions;
  for (Eigen::Index v = 0; v < moved.rows(); ++v) {
    if (moved(v, 2) > 0.3) moved(v, 0) *= 1.2;
  }
  EXPECT_NE(tree.evaluate(moved).value, first.value);
  const KnotValue again = tree.evaluate(folded.positions);
  EXPECT_EQ(again.value, first.value);
  EXPECT_EQ(again.gradient, first.gradient);
}

TEST(MultipoleTree, FollowsPositionsAwayFromThoseOfItsConstruction) {
  const TriangleMesh sphere = geometry::makeFoldedSphere(2);
  const MultipoleTree tree(sphere, everyVertex(sphere));
  TriangleMesh moved = sphere;
  moved.positions.col(0) *= 1.5;
  moved.positions.col(1).array() += 0.3 * sphere.positions.col(2).array().square();
  const KnotValue again = tree.evaluate(moved.positions);
  const KnotValue fresh = AllPairs(moved, everyVertex(moved)).evaluate(moved.positions);
  EXPECT_NEAR(again.value, fresh.value, 1e-3 * fresh.value);
  EXPECT_LT((again.gradient - fresh.gradient).norm(), 1e-3 * fresh.gradient.norm());
}

TEST(MultipoleTree, ScalesWithTheSquareOfTheSizeToTheLastBit) {
  // Scaling by a power of two changes exponents only.
  const TriangleMesh folded = geometry::makeFoldedSphere(2);
  TriangleMesh large = folded;
  large.positions *= 1024;
  const KnotValue small = MultipoleTree(folded, everyVertex(folded)).evaluate(folded.positions);
  const KnotValue big = MultipoleTree(large, everyVertex(large)).evaluate(large.positions);
  EXPECT_EQ(big.value, 1024.0 * 1024 * small.value);
  EXPECT_EQ(big.gradient, 1024 * small.gradient);
}

TEST(MultipoleTree, IsUnmovedByRigidMotion) {
  const TriangleMesh folded = geometry::makeFoldedSphere(2);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Vector(1, 2, -2).normalized()).toRotationMatrix();
  TriangleMesh moved = folded;
  moved.positions =
      (folded.positions * turn.transpose()).rowwise() + Vector(90, -70, 50).transpose();
  const KnotValue before = MultipoleTree(folded, everyVertex(folded)).evaluate(folded.positions);
  const KnotValue after = MultipoleTree(moved, everyVertex(moved)).evaluate(moved.positions);
  EXPECT_NEAR(after.value, before.value, 1e-3 * before.value);
  EXPECT_LT((after.gradient - before.gradient * turn.transpose()).norm(),
            1e-3 * before.gradient.norm());
}

TEST(MultipoleTree, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh folded = geometry::makeFoldedSphere(4);
  const MultipoleTree tree(folded, cap(folded, 0));
  setThreadCount(1);
  const KnotValue one = tree.evaluate(folded.positions);
  setThreadCount(2);
  const KnotValue two = tree.evaluate(folded.positions);
  setThreadCount(4);
  const KnotValue four = tree.evaluate(folded.positions);
  setThreadCount(0);
  EXPECT_EQ(one.value, two.value);
  EXPECT_EQ(one.gradient, two.gradient);
  EXPECT_EQ(one.value, four.value);
  EXPECT_EQ(one.gradient, four.gradient);
}

TEST(MultipoleTree, InstructionSetsDifferByTheRoundingOfSinglePrecision) {
  const TriangleMesh folded = geometry::makeFoldedSphere(3);
  const MultipoleTree tree(folded, everyVertex(folded));
  const KnotValue widest = tree.evaluate(folded.positions);
  testing::forEachNarrowerInstructionSet([&](std::int64_t target) {
    const KnotValue narrow = tree.evaluate(folded.positions);
    EXPECT_NEAR(narrow.value, widest.value, 1e-6 * widest.value) << target;
    EXPECT_LT((narrow.gradient - widest.gradient).norm(), 1e-5 * widest.gradient.norm()) << target;
  });
}

TEST(MultipoleTree, StaysFiniteForFacesWithoutAreaAndSheetsInContact) {
  TriangleMesh sheet = geometry::makeRectangle(4, 4, 1, 1);
  sheet.positions.row(7) = sheet.positions.row(6);  // two vertices in one place
  const KnotValue v = MultipoleTree(sheet, everyVertex(sheet)).evaluate(sheet.positions);
  EXPECT_TRUE(std::isfinite(v.value));
  EXPECT_TRUE(v.gradient.allFinite());

  TriangleMesh twice = geometry::makeRectangle(2, 2, 1, 1);
  const Eigen::Index n = twice.vertexCount();
  const Eigen::Index f = twice.faceCount();
  twice.positions.conservativeResize(2 * n, 3);
  twice.positions.bottomRows(n) = twice.positions.topRows(n).eval();
  twice.faces.conservativeResize(2 * f, 3);
  twice.faces.bottomRows(f) = twice.faces.topRows(f).array() + static_cast<std::int32_t>(n);
  twice.positions.bottomRows(n).col(0).array() += 0.25;
  const KnotValue contact = MultipoleTree(twice, everyVertex(twice)).evaluate(twice.positions);
  EXPECT_TRUE(std::isfinite(contact.value));
  EXPECT_TRUE(contact.gradient.allFinite());
}

TEST(MultipoleTree, RefusesOptionsOutOfRange) {
  const TriangleMesh sphere = geometry::makeIcosphere(0);
  EXPECT_THROW(MultipoleTree(sphere, everyVertex(sphere), {1.0, 2.0}), InvalidInput);
  EXPECT_THROW(MultipoleTree(sphere, everyVertex(sphere), {0.0, 2.0}), InvalidInput);
  EXPECT_THROW(MultipoleTree(sphere, everyVertex(sphere), {0.5, 0.5}), InvalidInput);
}

TEST(MultipoleTree, OfNothingThatMovesIsZero) {
  const TriangleMesh sphere = geometry::makeIcosphere(1);
  const std::vector<bool> none(static_cast<std::size_t>(sphere.vertexCount()), false);
  const KnotValue v = MultipoleTree(sphere, none).evaluate(sphere.positions);
  EXPECT_EQ(v.value, 0);
  EXPECT_EQ(v.gradient.norm(), 0);
}

}  // namespace
}  // namespace explica::repulsion
