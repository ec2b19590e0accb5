// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Ventricle.h"

#include "Explica/Core/Errors.h"
#include "Explica/Harmonic/Phantoms.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace explica;
using namespace explica::correspondence;

TEST(Ventricle, PhantomHasItsExactThicknessAwayFromTheBase) {
  const auto phantom = harmonic::makePhantom(harmonic::PhantomKind::Ventricle, {116, 1});
  const auto insulated = harmonic::maskOf(phantom.labels, {4});
  const auto annulus = harmonic::annulusFromLevels(
      phantom.innerLevel, phantom.outerLevel, {0, harmonic::LevelInside::Below}, {}, insulated);
  const auto interpolant = harmonic::solveInterpolant(annulus);
  const auto found = findCorrespondences(annulus, interpolant);
  std::size_t seen = 0;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    const Point x = annulus.world(n);
    if (x[2] > 3) continue;  // a wall's thickness below the base
    ++seen;
    ASSERT_NEAR(found.thickness(n), phantom.exact.answer(x).thickness(), 0.1);
  }
  EXPECT_GT(seen, 10000U);
}

TEST(Ventricle, SegmentsTurnFromTheInsertionToTheSeptum) {
  // A tube along k that narrows with k: the apex is at the high end, the viewer beyond it.
  Volume<Label> labels(harmonic::centredGrid({61, 61, 9}, {1, 1, 8}), 0);
  for (int k = 0; k < 9; ++k) {
    for (int j = 0; j < 61; ++j) {
      for (int i = 0; i < 61; ++i) {
        const double r = std::hypot(i - 30, j - 30);
        labels(i, j, k) = r < 18 - k ? 1 : r < 26 - k ? 2 : 0;
      }
    }
  }
  harmonic::AnnulusOptions options;
  options.perSlice = true;
  const auto annulus = harmonic::annulusFromLabels(labels, {{1}, {2}, {}, {}}, options);
  const auto found = findCorrespondences(annulus, harmonic::solveInterpolant(annulus));
  const auto segments = wallSegments(annulus, found, Point(22, 0, 0));
  EXPECT_TRUE(segments.apexAtHighSlice);
  const auto segmentAt = [&](int i, int j, int k) {
    for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
      if ((annulus.index(n) - Vector(i, j, k)).norm() < 0.1) return segments.segmentOf[n];
    }
    return -1;
  };
  // Angles grow from +i towards +j, right-handed about +k.
  EXPECT_EQ(segmentAt(50, 35, 0), 2);
  EXPECT_EQ(segmentAt(30, 52, 0), 3);
  EXPECT_EQ(segmentAt(8, 35, 0), 4);
  EXPECT_EQ(segmentAt(50, 25, 0), 1);
  EXPECT_EQ(segmentAt(30, 49, 4), 9);
  EXPECT_EQ(segmentAt(30, 45, 8), 14);
  for (const auto& row : segments.rows) {
    if (row.segment == 17) {
      EXPECT_EQ(row.voxels, 0U);
    } else {
      EXPECT_NEAR(row.mean, 8, 0.15) << row.name;
    }
  }
  EXPECT_NE(tableOf(segments).find("16\tapical lateral\t"), std::string::npos);
  EXPECT_NE(bullseyeOf(segments).find("</svg>"), std::string::npos);
}
