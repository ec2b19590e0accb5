// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/StoppableLdlt.h"

#include "Explica/Core/StopScope.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"

#include <gtest/gtest.h>

namespace explica::geometry {
namespace {

Eigen::SparseMatrix<double> diffusionOn(const TriangleMesh& mesh) {
  Eigen::SparseMatrix<double> matrix = 2.0 * cotangentLaplacian(mesh);
  const Eigen::VectorXd masses = vertexAreas(mesh);
  for (Eigen::Index v = 0; v < matrix.rows(); ++v) matrix.coeffRef(v, v) += masses[v];
  return matrix;
}

TEST(StoppableLdlt, HasTheNumbersOfEigens) {
  const Eigen::SparseMatrix<double> matrix = diffusionOn(makeFoldedSphere(3, 30.0));
  const StoppableLdlt ours(matrix);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> theirs(matrix);
  ASSERT_EQ(ours.info(), Eigen::Success);
  const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(matrix.rows(), -1, 3);
  EXPECT_EQ(ours.solve(right), theirs.solve(right));
  EXPECT_EQ(ours.vectorD(), theirs.vectorD());
}

TEST(StoppableLdlt, TellsASingularMatrix) {
  Eigen::SparseMatrix<double> matrix(3, 3);
  matrix.insert(0, 0) = 1;
  EXPECT_EQ(StoppableLdlt(matrix).info(), Eigen::NumericalIssue);
}

TEST(StoppableLdlt, HearsAStopWithinTheFactorisation) {
  const Eigen::SparseMatrix<double> matrix = diffusionOn(makeFoldedSphere(4, 30.0));
  int asked = 0;
  Monitor monitor;
  monitor.stopWanted = [&] { return ++asked == 20; };
  const StopScope scope(&monitor);
  EXPECT_THROW(StoppableLdlt{matrix}, Interrupted);
  EXPECT_EQ(asked, 20);
}

}  // namespace
}  // namespace explica::geometry
