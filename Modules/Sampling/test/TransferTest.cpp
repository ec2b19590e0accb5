// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/Transfer.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::sampling {
namespace {

TEST(Transfer, CarriesALinearMapFromOneMeshToAnother) {
  const TriangleMesh theirs = geometry::makeIcosphere(5, 20.0),
                     ours = geometry::makeIcosphere(4, 20.5);
  const NearestOnSurface nearest = nearestOn(theirs, ours.positions);
  EXPECT_NEAR(nearest.distance.maxCoeff(), 0.5, 0.01);
  EXPECT_LT((nearest.weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-12);
  const Eigen::VectorXd got = carryOver(nearest, theirs.positions.col(1));
  EXPECT_LT((got - 20 / 20.5 * ours.positions.col(1)).cwiseAbs().maxCoeff(), 0.02);
}

TEST(Transfer, KnowsOnlyWhatTheOtherKnows) {
  const TriangleMesh mesh = geometry::makeRectangle(2, 1, 2, 1);
  Eigen::VectorXd values = mesh.positions.col(0);
  for (Eigen::Index v = 0; v < values.size(); ++v) {
    if (values[v] > 1.5) values[v] = kNaN;
  }
  Positions points(3, 3);
  points << 0.5, 0.5, 1, 1.1, 0.5, 0, 1.9, 0.5, 0;
  const Eigen::VectorXd got = carryOver(nearestOn(mesh, points), values);
  EXPECT_NEAR(got[0], 0.5, 1e-12);
  EXPECT_NEAR(got[1], 1, 1e-12);
  EXPECT_TRUE(std::isnan(got[2]));
  EXPECT_THROW(static_cast<void>(carryOver(nearestOn(mesh, points), Eigen::VectorXd(2))),
               InvalidInput);
}

}  // namespace
}  // namespace explica::sampling
