// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Surface/CorticalTissue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace explica::surface {
namespace {

/// What a program calls the parts of a small brain; each list is used up voxel by voxel.
struct Convention {
  std::string name;
  LabelPreset preset;
  bool guessed;
  bool sided;
  std::vector<Label> white[2], grey[2], fill[2];  ///< left, right
  std::vector<Label> outside;
};

std::ostream& operator<<(std::ostream& out, const Convention& c) {
  return out << c.name;
}

std::vector<Label> from(Label first, Label last, Label step = 1) {
  std::vector<Label> labels;
  for (Label label = first; label <= last; label += step) labels.push_back(label);
  return labels;
}

const std::vector<Convention>& conventions() {
  static const std::vector<Convention> all = {
      {"SynthSeg",
       LabelPreset::Aseg,
       true,
       true,
       {{2}, {41}},
       {{3}, {42}},
       {{4, 5, 10, 11, 12, 13, 17, 18, 26, 28}, {43, 44, 49, 50, 51, 52, 53, 54, 58, 60}},
       {0, 7, 8, 24, 46, 47}},
      {"SynthSegParcels",
       LabelPreset::Aseg,
       true,
       true,
       {{2}, {41}},
       {from(1001, 1035), from(2001, 2035)},
       {{4, 10}, {43, 49}},
       {0, 24}},
      {"FastSurfer",
       LabelPreset::Aseg,
       true,
       true,
       {{2}, {41}},
       {{1002, 1003, 1005, 1035}, {2002, 2003, 2005, 2035}},
       {{4, 10, 31}, {43, 49, 63}},
       {0, 24}},
      {"Destrieux",
       LabelPreset::Aseg,
       true,
       true,
       {{2}, {41}},
       {from(11101, 11175), from(12101, 12175)},
       {{4, 10}, {43, 49}},
       {0, 24}},
      {"DestrieuxBeforeVersion5",
       LabelPreset::Aseg,
       true,
       true,
       {{2}, {41}},
       {from(1101, 1175), from(2101, 2175)},
       {{4, 10}, {43, 49}},
       {0, 24}},
      {"Wmparc",
       LabelPreset::Aseg,
       true,
       true,
       {{3001, 3035, 5001}, {4001, 4035, 5002}},
       {{1001, 1035}, {2001, 2035}},
       {{4, 10}, {43, 49}},
       {0, 24}},
      {"InfantFreeSurfer",
       LabelPreset::Aseg,
       true,
       true,
       {{2}, {41}},
       {{3}, {42}},
       {{4, 9, 11}, {43, 48, 50}},
       {0, 7, 8, 46, 47, 173, 174, 175}},
      {"HcpRibbon", LabelPreset::Ribbon, true, true, {{2}, {41}}, {{3}, {42}}, {{}, {}}, {0}},
      {"ThreeClasses",
       LabelPreset::ThreeClass,
       true,
       false,
       {{3}, {3}},
       {{2}, {2}},
       {{}, {}},
       {0, 1}},
      {"Ants", LabelPreset::Ants, true, false, {{3}, {3}}, {{2}, {2}}, {{4}, {4}}, {0, 1, 5, 6}},
      {"Dhcp",
       LabelPreset::Dhcp,
       true,
       false,
       {{3}, {3}},
       {{2}, {2}},
       {{5, 7, 9}, {5, 7, 9}},
       {0, 1, 4, 6, 8}},
      {"Dhcp87",
       LabelPreset::Dhcp87,
       true,
       true,
       {{51, 53, 80, 82, 64}, {52, 54, 79, 81, 63}},
       {{5, 7, 21, 37, 39}, {6, 8, 20, 36, 38}},
       {{1, 41, 43, 49, 87}, {2, 40, 42, 50, 86}},
       {0, 17, 18, 83, 84, 85}},
      {"Nmt", LabelPreset::Nmt, false, false, {{4}, {4}}, {{3}, {3}}, {{2}, {2}}, {0, 1, 5}},
      {"LayNii", LabelPreset::LayNii, true, false, {{2}, {2}}, {{3}, {3}}, {{}, {}}, {1}}};
  return all;
}

/// Two balls side by side: filled structures in white matter in a ribbon in what lies outside; each
/// part's labels follow each other voxel by voxel.
Volume<Label> brainOf(const Convention& names) {
  Grid grid;
  grid.size = {76, 40, 40};
  Volume<Label> labels(grid);
  std::size_t turn = 0;
  const auto next = [&](const std::vector<Label>& list) { return list[turn++ % list.size()]; };
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto s = grid.subscripts(v);
    const int side = s[0] < 38 ? 0 : 1;
    const double x = s[0] - (side == 0 ? 20.5 : 55.5);
    const double r = std::sqrt(x * x + std::pow(s[1] - 19.5, 2) + std::pow(s[2] - 19.5, 2));
    const bool filled = r < 4 && !names.fill[side].empty();
    labels[v] = filled   ? next(names.fill[side])
                : r < 10 ? next(names.white[side])
                : r < 13 ? next(names.grey[side])
                : r < 16 ? next(names.outside)
                         : 0;
  }
  return labels;
}

std::int64_t countOf(const Volume<std::uint8_t>& mask) {
  return std::count(mask.data.begin(), mask.data.end(), std::uint8_t{1});
}

class LabelPresetOf : public testing::TestWithParam<Convention> {};

TEST_P(LabelPresetOf, FindsEachHemispheresParts) {
  const Convention& names = GetParam();
  const Volume<Label> labels = brainOf(names);
  TissueOptions options;
  options.preset = names.guessed ? LabelPreset::Auto : names.preset;
  if (names.sided) {
    EXPECT_THROW((void)masksFromLabels(labels, options), InvalidInput);
    options.hemisphere = Side::Right;
  }
  const TissueMasks masks = masksFromLabels(labels, options);
  EXPECT_EQ(masks.preset, names.preset);
  EXPECT_EQ(masks.structure, names.sided ? "CortexRight" : "Cortex");
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto s = labels.grid.subscripts(v);
    const bool right = s[0] >= 38;
    const double x = s[0] - (right ? 55.5 : 20.5);
    const double r = std::sqrt(x * x + std::pow(s[1] - 19.5, 2) + std::pow(s[2] - 19.5, 2));
    const bool ours = !names.sided || right;
    ASSERT_EQ(masks.white[v] != 0, ours && r < 10) << "label " << labels[v];
    ASSERT_EQ(masks.grey[v] != 0, ours && r >= 10 && r < 13) << "label " << labels[v];
    if (ours || r >= 13) continue;
    ASSERT_EQ(masks.insulated[v] != 0, r < 10) << "label " << labels[v];
  }
  EXPECT_EQ(masks.greyVoxels, countOf(masks.grey));
}

INSTANTIATE_TEST_SUITE_P(Programs, LabelPresetOf, testing::ValuesIn(conventions()),
                         [](const auto& tested) { return tested.param.name; });

TEST(TissueLabels, ThoseAbsentBesideOthersOfTheirListAreNamed) {
  Grid grid;
  grid.size = {16, 16, 16};
  grid.spacing = Vector(1, 1, 2);
  Volume<Label> labels(grid, 0);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto s = grid.subscripts(v);
    const int r = std::max({std::abs(s[0] - 8), std::abs(s[1] - 8), std::abs(s[2] - 8)});
    labels[v] = r < 4 ? 5 : r < 6 ? 7 : 0;
  }
  std::vector<std::string> warnings;
  Monitor monitor;
  monitor.onWarning = [&](const std::string& message) { warnings.push_back(message); };
  TissueOptions options;
  options.white = {4, 5, 6};
  options.grey = {7, 8};
  const TissueMasks masks = masksFromLabels(labels, options, monitor);
  EXPECT_EQ(masks.whiteVoxels, 343);
  EXPECT_EQ(masks.greyVoxels, 1331 - 343);
  ASSERT_EQ(warnings.size(), 2U);
  EXPECT_NE(warnings[0].find("white: label 4, 6 absent"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[1].find("grey: label 8 absent"), std::string::npos) << warnings[1];
  options.grey = {8, 9};
  EXPECT_THROW((void)masksFromLabels(labels, options), InvalidInput);
}

TEST(LabelPreset, OfAMacaqueTemplateIsNotGuessed) {
  const auto nmt = std::find_if(conventions().begin(), conventions().end(),
                                [](const Convention& c) { return c.name == "Nmt"; });
  EXPECT_THROW((void)masksFromLabels(brainOf(*nmt)), InvalidInput);
}

TEST(LabelPreset, GrowsABorderLineWhereVoxelsHaveNoLabel) {
  // Lines of one voxel on either side of a slab that runs out of the image; between lines and grey
  // matter some voxels have lost their label.
  Grid grid;
  grid.size = {20, 20, 20};
  Volume<Label> labels(grid);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto s = grid.subscripts(v);
    labels[v] = s[0] == 5 ? 2 : (s[0] > 5 && s[0] < 12 ? 3 : (s[0] == 12 ? 1 : 0));
  }
  labels(5, 7, 7) = labels(12, 9, 9) = 0;
  const TissueMasks masks = masksFromLabels(labels);
  EXPECT_EQ(masks.preset, LabelPreset::LayNii);
  EXPECT_TRUE(masks.white(5, 7, 7));
  EXPECT_FALSE(masks.white(12, 9, 9) || masks.grey(12, 9, 9) || masks.insulated(12, 9, 9));
  EXPECT_TRUE(masks.white(4, 3, 3) && masks.white(3, 3, 3) && !masks.white(1, 3, 3));
  EXPECT_TRUE(masks.insulated(0, 3, 3) && masks.insulated(19, 3, 3));
  EXPECT_EQ(masks.greyVoxels, 6 * 400);
}

}  // namespace
}  // namespace explica::surface
