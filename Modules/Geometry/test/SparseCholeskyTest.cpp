// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/SparseCholesky.h"

#include "Explica/Core/StopScope.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"

#include <gtest/gtest.h>
#include <Eigen/SparseCholesky>

#include <atomic>

namespace explica::geometry {
namespace {

Eigen::SparseMatrix<double> diffusionOn(const TriangleMesh& mesh) {
  Eigen::SparseMatrix<double> matrix = 2.0 * cotangentLaplacian(mesh);
  const Eigen::VectorXd masses = vertexAreas(mesh);
  for (Eigen::Index v = 0; v < matrix.rows(); ++v) matrix.coeffRef(v, v) += masses[v];
  return matrix;
}

TEST(SparseCholesky, SolvesAsEigenDoes) {
  const Eigen::SparseMatrix<double> matrix = diffusionOn(makeFoldedSphere(4, 30.0));
  const SparseCholesky ours(matrix);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> theirs(matrix);
  ASSERT_TRUE(ours.isDefinite());
  Eigen::MatrixXd right(matrix.rows(), 2);
  right.col(0).setLinSpaced(-1, 3);
  right.col(1).setOnes();
  const Eigen::MatrixXd expected = theirs.solve(right);
  EXPECT_LT((ours.solve(right) - expected).norm(), 1e-12 * expected.norm());
}

TEST(SparseCholesky, ReadsTheLowerTriangleAlone) {
  const Eigen::SparseMatrix<double> matrix = diffusionOn(makeFoldedSphere(2, 30.0));
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(matrix.rows(), -1, 3);
  const Eigen::SparseMatrix<double> lower = matrix.triangularView<Eigen::Lower>();
  EXPECT_EQ(SparseCholesky(lower).solve(right), SparseCholesky(matrix).solve(right));
}

TEST(SparseCholesky, TellsAMatrixThatIsNotDefinite) {
  Eigen::SparseMatrix<double> matrix(3, 3);
  matrix.insert(0, 0) = 1;
  EXPECT_FALSE(SparseCholesky(matrix).isDefinite());
  matrix.setIdentity();
  EXPECT_TRUE(SparseCholesky(matrix).isDefinite());
  matrix.coeffRef(1, 1) = -1;
  EXPECT_FALSE(SparseCholesky(matrix).isDefinite());
}

TEST(SparseCholesky, HearsAStopWithinTheFactorisation) {
  const Eigen::SparseMatrix<double> matrix = diffusionOn(makeFoldedSphere(5, 30.0));
  for (const int last : {1, 5, 50}) {
    std::atomic<int> asked = 0;  // only once, so that a loop that goes on after it is caught
    Monitor monitor;
    monitor.stopWanted = [&] { return ++asked == last; };
    const StopScope scope(&monitor);
    EXPECT_THROW(SparseCholesky{matrix}, Interrupted) << last;
  }
}

}  // namespace
}  // namespace explica::geometry
