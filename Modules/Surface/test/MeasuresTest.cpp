// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Surface/Measures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::surface {
namespace {

double integral(const TriangleMesh& mesh, const Eigen::VectorXd& values) {
  return geometry::vertexAreas(mesh).dot(values);
}

TEST(MeanOverSurroundings, KeepsConstantsAndIntegrals) {
  const TriangleMesh ball = geometry::makeIcosphere(3, 20);
  const Eigen::VectorXd same = Eigen::VectorXd::Constant(ball.vertexCount(), 2.5);
  EXPECT_LT((meanOverSurroundings(ball, same) - same).cwiseAbs().maxCoeff(), 1e-12);
  const Eigen::VectorXd wave = 3 + (ball.positions.col(0).array() * 0.4).sin();
  EXPECT_NEAR(integral(ball, meanOverSurroundings(ball, wave)), integral(ball, wave),
              1e-10 * integral(ball, wave));
}

TEST(MeanOverSurroundings, ChangesSmoothFunctionsToSecondOrder) {
  double previous = 0;
  for (const int level : {3, 4, 5}) {
    const TriangleMesh ball = geometry::makeIcosphere(level, 20);
    const Eigen::VectorXd wave = 3 + (ball.positions.col(2).array() * 0.1).sin();
    const double off = (meanOverSurroundings(ball, wave) - wave).cwiseAbs().mean();
    if (previous > 0) {
      EXPECT_NEAR(std::log2(previous / off), 2, 0.2);
    }
    previous = off;
  }
}

TEST(MeanOverSurroundings, LeavesWhatIsNotKnownOut) {
  const TriangleMesh ball = geometry::makeIcosphere(2, 20);
  Eigen::VectorXd half(ball.vertexCount());
  for (Eigen::Index v = 0; v < half.size(); ++v) half[v] = ball.positions(v, 0) > 0 ? 4 : 0;
  EXPECT_EQ(meanOverSurroundings(ball, half), half);
}

}  // namespace
}  // namespace explica::surface
