// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/NearestColumn.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"

#include <gtest/gtest.h>

namespace explica::sampling {
namespace {

TEST(NearestColumn, TellsVertexDepthAndDistance) {
  const TriangleMesh white = geometry::makeIcosphere(3, 10.0),
                     pial = geometry::makeIcosphere(3, 14.0);
  Positions points(4, 3);
  const Eigen::RowVector3d out = white.positions.row(100).normalized();
  points.row(0) = 11 * out;
  points.row(1) = 20 * out;  // an electrode above the brain
  points.row(2) = 8 * out;   // in white matter
  points.row(3) = 12 * out + 0.1 * out.cross(Eigen::RowVector3d(0, 0, 1)).normalized();
  const std::vector<ColumnPlace> places = nearestColumns(white, pial, points);
  const double depth[] = {0.25, 1, 0, 0.5}, distance[] = {0, 6, 2, 0.1};
  for (int p = 0; p < 4; ++p) {
    EXPECT_EQ(places[p].vertex, 100);
    EXPECT_NEAR(places[p].depth, depth[p], 1e-9);
    EXPECT_NEAR(places[p].distance, distance[p], 1e-9);
  }
  points(2, 1) = kNaN;
  EXPECT_THROW(static_cast<void>(nearestColumns(white, pial, points)), InvalidInput);
}

}  // namespace
}  // namespace explica::sampling
