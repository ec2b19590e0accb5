// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/DenseKernels.h"

#include "Explica/Core/Types.h"
#include "Explica/Testing/InstructionSets.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <gtest/gtest.h>

#include <vector>

namespace explica::geometry {
namespace {

using kernels::DenseBlock;

DenseBlock blockOf(Eigen::MatrixXd& m) {
  return {m.data(), m.rows(), m.cols(), m.rows()};
}

/// The same for every run and machine.
Eigen::MatrixXd anyMatrix(Eigen::Index rows, Eigen::Index columns, std::uint32_t seed) {
  Eigen::MatrixXd m(rows, columns);
  for (Eigen::Index n = 0; n < m.size(); ++n) {
    seed = 1664525U * seed + 1013904223U;
    m.data()[n] = static_cast<double>(seed) / 4294967296.0 - 0.5;
  }
  return m;
}

TEST(DenseKernels, ProductIsSubtractedOnAndBelowTheDiagonalAtEverySize) {
  for (const Eigen::Index rows : {1, 2, 5, 16, 17, 33, 100, 250}) {
    for (const Eigen::Index depth : {1, 3, 24, 96, 100, 193}) {
      Eigen::MatrixXd left = anyMatrix(rows, depth, 1);
      const Eigen::MatrixXd start = anyMatrix(rows, rows, 2);
      Eigen::MatrixXd target = start;
      kernels::subtractProduct(blockOf(left), blockOf(left), blockOf(target));
      const Eigen::MatrixXd expected = start - left * left.transpose();
      for (Eigen::Index j = 0; j < rows; ++j) {
        EXPECT_LT((target - expected).col(j).tail(rows - j).norm(), 1e-12) << rows << " " << depth;
      }
    }
  }
}

TEST(DenseKernels, ATargetFarBelowTheDiagonalIsWhole) {
  Eigen::MatrixXd left = anyMatrix(37, 50, 3), right = anyMatrix(20, 50, 4);
  const Eigen::MatrixXd start = anyMatrix(37, 20, 5);
  Eigen::MatrixXd target = start;
  kernels::subtractProduct(blockOf(left), blockOf(right), blockOf(target), 20);
  EXPECT_LT((target - (start - left * right.transpose())).norm(), 1e-12);
}

TEST(DenseKernels, CornerAndWhatIsBelowAreThoseOfCholesky) {
  for (const Eigen::Index size : {1, 2, 7, 24}) {
    const Eigen::MatrixXd any = anyMatrix(size, size, 6);
    const Eigen::MatrixXd matrix = any * any.transpose() + Eigen::MatrixXd::Identity(size, size);
    Eigen::MatrixXd corner = matrix;
    ASSERT_TRUE(kernels::factoriseCorner(blockOf(corner)));
    const Eigen::MatrixXd factor = corner.triangularView<Eigen::Lower>();
    EXPECT_LT((factor * factor.transpose() - matrix).norm(), 1e-12 * matrix.norm());
    for (const Eigen::Index rows : {1, 5, 8, 61}) {
      const Eigen::MatrixXd start = anyMatrix(rows, size, 7);
      Eigen::MatrixXd below = start;
      kernels::solveBelow(blockOf(corner), blockOf(below));
      EXPECT_LT((below * factor.transpose() - start).norm(), 1e-12 * start.norm());
    }
  }
}

TEST(DenseKernels, IndefiniteAndInfiniteCornersAreRefused) {
  Eigen::MatrixXd corner(2, 2);
  corner << 1, 0, 2, 1;
  EXPECT_FALSE(kernels::factoriseCorner(blockOf(corner)));
  corner << kInfinity, 0, 0, 1;
  EXPECT_FALSE(kernels::factoriseCorner(blockOf(corner)));
}

std::vector<Eigen::MatrixXd> everything() {
  Eigen::MatrixXd left = anyMatrix(75, 60, 8), target = anyMatrix(75, 75, 9);
  kernels::subtractProduct(blockOf(left), blockOf(left), blockOf(target));
  Eigen::MatrixXd corner = anyMatrix(20, 20, 10), below = anyMatrix(43, 20, 11);
  corner.diagonal().array() += 2;
  kernels::solveBelow(blockOf(corner), blockOf(below));
  return {target.triangularView<Eigen::Lower>(), below};
}

TEST(DenseKernels, EveryInstructionSetGivesTheSameBits) {
  const auto widest = everything();
  testing::forEachNarrowerInstructionSet(
      [&](std::int64_t target) { EXPECT_TRUE(everything() == widest) << target; });
}

}  // namespace
}  // namespace explica::geometry
