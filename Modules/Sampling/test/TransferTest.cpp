// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/Transfer.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"

#include <gtest/gtest.h>

namespace explica::sampling {
namespace {

TEST(Transfer, NearestPointsCarryALinearMapFromOneMeshToAnother) {
  const TriangleMesh theirs = geometry::makeIcosphere(5, 20.0),
                     ours = geometry::makeIcosphere(4, 20.5);
  const NearestOnSurface nearest = nearestOn(theirs, ours.positions);
  EXPECT_NEAR(nearest.distance.maxCoeff(), 0.5, 0.01);
  EXPECT_LT((nearest.weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-12);
  for (Eigen::Index p = 0; p < ours.vertexCount(); ++p) {
    double y = 0;
    for (int c = 0; c < 3; ++c) {
      y += nearest.weights(p, c) * theirs.positions(nearest.corners(p, c), 1);
    }
    ASSERT_NEAR(y, 20 / 20.5 * ours.positions(p, 1), 0.02);
  }
  EXPECT_THROW(static_cast<void>(nearestOn({}, ours.positions)), InvalidInput);
}

}  // namespace
}  // namespace explica::sampling
