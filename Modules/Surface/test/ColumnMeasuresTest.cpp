// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/ColumnMeasures.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Harmonic/Phantoms.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::surface {
namespace {

TEST(ColumnMeasures, HaveTheAreaAndThicknessOfAShellHoweverCoarseTheMesh) {
  const auto phantom = harmonic::makePhantom(harmonic::PhantomKind::Shell, {64, 1});
  const auto annulus = harmonic::annulusFromLevels(phantom.innerLevel, phantom.outerLevel,
                                                   {0, harmonic::LevelInside::Below});
  const auto found =
      correspondence::findCorrespondences(annulus, harmonic::solveInterpolant(annulus));
  constexpr double kMiddle = 25, kThickness = 10;  // mm
  for (const int level : {1, 4}) {
    const TriangleMesh ball = geometry::makeIcosphere(level, kMiddle);
    const Columns columns = columnsAround(annulus, found, ball);
    // The columns' cross-section grows as r^2, so that the weights add (t / r)^2 / 24.
    EXPECT_NEAR(columns.area.sum() / (4 * kPi * kMiddle * kMiddle), 1 + 0.16 / 24, 0.005) << level;
    const Eigen::VectorXd vertices = thicknessAtVertices(annulus, found, ball);
    for (Eigen::Index v = 0; v < ball.vertexCount(); ++v) {
      EXPECT_NEAR(vertices[v], kThickness, 0.02);
      if (columns.area[v] > 0) {
        EXPECT_NEAR(columns.thickness[v], kThickness, 0.02);
      }
    }
  }
}

}  // namespace
}  // namespace explica::surface
