// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/Statistics.h"

#include "Explica/Core/Errors.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::sampling {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

TEST(AcrossDepths, CountsWhatIsKnown) {
  const std::vector<float> values = {1, kUnknown, kUnknown, 3, -4, kUnknown};  // 2 depths x 3
  const std::vector<float> mean = acrossDepths(values, 2, Across::Mean);
  EXPECT_EQ(mean[0], 2);
  EXPECT_EQ(mean[1], -4);
  EXPECT_TRUE(std::isnan(mean[2]));
  EXPECT_EQ(acrossDepths(values, 2, Across::Max)[1], -4);
}

TEST(AcrossDepths, LabelsGoToTheMajorityAndTiesToTheMiddle) {
  const std::vector<Label> labels = {3, 3, kNoLabel,   // white
                                     5, 3, kNoLabel,   // middle
                                     7, 5, kNoLabel};  // pial
  EXPECT_EQ(majorityAcross(labels, 3), (std::vector<Label>{5, 3, kNoLabel}));
}

TEST(Regions, HaveTheMomentsOfTheirVertices) {
  const std::vector<Label> keys = {2, 2, 2, 1, 0, 9};
  const Regions regions({{keys, {{1, "one"}, {2, "two"}, {3, "absent"}, {9, "nine"}}}});
  EXPECT_EQ(regions.names(), (std::vector<std::string>{"one", "two", "nine", "all"}));
  const std::vector<float> values = {1e6F, 1e6F + 2, kUnknown, 7, 100, kUnknown};
  const std::vector<Moments> got = regions.momentsOf(values);
  EXPECT_EQ(got[0].mean, 7);
  EXPECT_TRUE(std::isnan(got[0].deviation));
  EXPECT_EQ(got[1].mean, 1e6 + 1);
  EXPECT_DOUBLE_EQ(got[1].deviation, std::sqrt(2.0));
  EXPECT_EQ(got[2].count, 0U);
  EXPECT_TRUE(std::isnan(got[2].mean));
  EXPECT_EQ(got[3].count, 3U);
  EXPECT_EQ(regions.nameAt(3), "one");
  EXPECT_EQ(regions.nameAt(4), "");
  EXPECT_EQ(Regions(2).momentsOf(std::vector<float>{1, 3})[0].mean, 2);
  EXPECT_EQ(Regions(2).nameAt(1), "");
}

TEST(Regions, OfSeveralParcellationsMayOverlap) {
  const std::vector<Label> areas = {1, 1, 2, 0}, spot = {0, 5, 5, 0}, shorter = {1};
  const Regions regions({{areas, {{1, "V1"}, {2, "V2"}}}, {spot, {{5, "spot"}}}});
  EXPECT_EQ(regions.names(), (std::vector<std::string>{"V1", "V2", "spot", "all"}));
  const std::vector<Moments> got = regions.momentsOf(std::vector<float>{1, 2, 4, 100});
  EXPECT_EQ(got[0].mean, 1.5);
  EXPECT_EQ(got[2].mean, 3);
  EXPECT_EQ(got[3].count, 3U);
  EXPECT_EQ(regions.nameAt(1), "V1; spot");
  EXPECT_THROW(Regions({{areas, {{1, "V1"}}}, {shorter, {{1, "x"}}}}), InvalidInput);
}

}  // namespace
}  // namespace explica::sampling
