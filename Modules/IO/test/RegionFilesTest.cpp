// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/IO/RegionFiles.h"

#include "Explica/Core/Errors.h"
#include "Explica/IO/LabelNames.h"
#include "TemporaryFolder.h"

#include <gtest/gtest.h>

namespace explica::io {
namespace {

LabelMap mapOf(std::vector<Label> keys, std::vector<LabelEntry> table) {
  LabelMap labels{"parts", {}, std::move(table)};
  labels.keys = Eigen::Map<Eigen::Matrix<Label, Eigen::Dynamic, 1>>(
      keys.data(), static_cast<Eigen::Index>(keys.size()));
  return labels;
}

TEST(RegionFiles, KeepNamesAndColoursAndLeaveTheRestOut) {
  const TemporaryFolder folder;
  const LabelMap atlas = mapOf({0, 1, 1, 5, 3, 3}, {{0, "???", {0, 0, 0, 0}},
                                                    {1, "V1", {1, 0, 0, 1}},
                                                    {3, "Medial_wall", {0, 0, 0, 1}},
                                                    {4, "absent", {0, 1, 0, 1}},
                                                    {5, "V2", {0, 0, 1, 1}}});
  writeGiftiLabel(folder / "areas.label.gii", atlas, "CortexLeft");
  putContent(folder / "lh.MT.label", "#!ascii label\n2\n4 0 0 0 0\n1 0 0 0 0\n");
  const auto regions = readRegions({folder / "areas.label.gii", folder / "lh.MT.label"}, 6);
  ASSERT_EQ(regions.size(), 2u);
  EXPECT_EQ(regions[0].name, "areas");
  ASSERT_EQ(regions[0].table.size(), 2u);
  EXPECT_EQ(regions[0].table[1].name, "V2");
  EXPECT_EQ(regions[0].table[1].colour, (std::array<float, 4>{0, 0, 1, 1}));
  EXPECT_EQ(regions[0].keys[0], kNoRegion);
  EXPECT_EQ(regions[0].keys[4], kNoRegion);
  EXPECT_EQ(regions[0].keys[3], 5);
  EXPECT_EQ(regions[1].table[0].name, "lh.MT");
  EXPECT_EQ(regions[1].keys[1], 1);
  EXPECT_EQ(regions[1].keys[2], kNoRegion);
}

TEST(RegionFiles, NamesThatSeveralFilesShareAreToldApart) {
  const TemporaryFolder folder;
  const LabelMap one = mapOf({1, 0}, {{0, "unknown", {0, 0, 0, 0}}, {1, "V1", {1, 0, 0, 1}}});
  writeGiftiLabel(folder / "left.label.gii", one, "CortexLeft");
  writeGiftiLabel(folder / "old.label.gii", one, "CortexLeft");
  const auto regions = readRegions({folder / "left.label.gii", folder / "old.label.gii"}, 2);
  EXPECT_EQ(regions[0].table[0].name, "left V1");
  EXPECT_EQ(regions[1].table[0].name, "old V1");
}

TEST(RegionFiles, AFileWithoutARegionIsRefused) {
  const TemporaryFolder folder;
  const LabelMap none = mapOf({0, 0}, {{0, "???", {0, 0, 0, 0}}});
  writeGiftiLabel(folder / "none.label.gii", none, "CortexLeft");
  EXPECT_THROW((void)readRegions({folder / "none.label.gii"}, 2), InvalidInput);
}

TEST(LabelColours, OfMricronsLutAreRead) {
  const TemporaryFolder folder;
  std::string lut(768, '\0');
  lut[7] = '\xff';
  lut[512 + 7] = '\x33';
  putContent(folder / "aal.nii.lut", lut);
  const LabelColours colours = readLabelColours(*findColours(folder / "aal.nii.gz"));
  EXPECT_EQ(colours.at(7), (std::array<float, 4>{1, 0, 0.2F, 1}));
  EXPECT_FALSE(findColours(folder / "other.nii.gz").has_value());
  putContent(folder / "short.nii.lut", "abc");
  EXPECT_THROW((void)readLabelColours(folder / "short.nii.lut"), IOError);
}

}  // namespace
}  // namespace explica::io
