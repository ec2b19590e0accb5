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
  const Columns columns = columnsOf(annulus, found);
  // The columns' cross-section grows as r^2, so that the weights add (t / r)^2 / 24.
  const double whole = 4 * kPi * kMiddle * kMiddle * (1 + 0.16 / 24);
  EXPECT_NEAR(columns.area.sum() / whole, 1, 0.005);
  double cap = 0;  // of half the height of its half
  for (Eigen::Index c = 0; c < columns.area.size(); ++c) {
    EXPECT_NEAR(columns.thickness[c], kThickness, 0.02);
    const Vector inner = columns.inner.row(c), outer = columns.outer.row(c);
    EXPECT_NEAR(inner.dot(outer), inner.norm() * outer.norm(), 0.5);
    if (inner.z() > 0.5 * inner.norm()) cap += columns.area[c];
  }
  EXPECT_NEAR(cap / whole, 0.25, 0.005);
  for (const int level : {1, 4}) {
    const TriangleMesh ball = geometry::makeIcosphere(level, kMiddle);
    for (const double thickness : thicknessAtVertices(annulus, found, ball)) {
      EXPECT_NEAR(thickness, kThickness, 0.02) << level;
    }
  }
}

}  // namespace
}  // namespace explica::surface
