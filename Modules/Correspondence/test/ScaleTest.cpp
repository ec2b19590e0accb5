// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Correspondence/Measurement.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::correspondence {
namespace {

/// Two banks of inner region whose tissue meets between them, and an open side; `unit` mm to a
/// voxel.
Measurement measuredAt(double unit) {
  Grid grid;
  grid.size = {40, 36, 32};
  grid.spacing = unit * Vector(1, 1.25, 1.5);
  Volume<Label> labels(grid);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto at = grid.subscripts(v);
    const Vector p = Vector(at[0], 1.25 * at[1], 1.5 * at[2]) - Vector(19.5, 22, 23);
    const double left = (p + Vector(7.3, 0, 0)).norm(), right = (p - Vector(8, 0, 0)).norm();
    const double nearest = std::min(left, right);
    labels[v] = nearest < 5 ? 1 : nearest < 9.5 ? 2 : 0;
  }
  harmonic::LabelRoles roles;
  roles.inner = {1};
  roles.tissue = {2};
  MeasurementOptions options;
  options.sulci = SulciMode::Recover;
  return measure(harmonic::annulusFromLabels(labels, roles), options);
}

class ThicknessScale : public ::testing::TestWithParam<int> {};

TEST_P(ThicknessScale, ByAPowerOfTwoChangesNoBitOfTheResult) {
  const double unit = std::ldexp(1.0, GetParam());
  const Measurement here = measuredAt(1), there = measuredAt(unit);
  EXPECT_FALSE(here.sulcalVoxels.empty());
  EXPECT_EQ(there.sulcalVoxels, here.sulcalVoxels);
  EXPECT_EQ(there.interpolant.u, here.interpolant.u);
  const auto expected = thicknessOf(here.correspondence), got = thicknessOf(there.correspondence);
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t n = 0; n < got.size(); ++n) {
    if (std::isnan(expected[n])) {
      EXPECT_TRUE(std::isnan(got[n]));
    } else {
      EXPECT_EQ(got[n], unit * expected[n]);
    }
  }
  EXPECT_EQ(there.layers, here.layers);
}

INSTANTIATE_TEST_SUITE_P(VoxelSizes, ThicknessScale, ::testing::Values(-20, -10, 10, 20));

TEST(ThicknessScale, ByAThousandChangesTheResultByRounding) {
  const ThicknessSummary here = summaryOf(measuredAt(1).correspondence);
  for (const double unit : {1e-3, 1e3}) {
    const ThicknessSummary there = summaryOf(measuredAt(unit).correspondence);
    EXPECT_NEAR(there.mean / unit, here.mean, 1e-4 * here.mean);
    EXPECT_NEAR(there.median / unit, here.median, 1e-3 * here.median);
  }
}

}  // namespace
}  // namespace explica::correspondence
