// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/Plausibility.h"

#include "Explica/Core/Errors.h"
#include "Explica/Segmentation/Atlas.h"
#include "Explica/Segmentation/Summary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

namespace explica::segmentation {
namespace {

Grid cube(int size) {
  Grid grid;
  grid.size = {size, size, size};
  return grid;
}

/// Whole grey values with noise, as scanners store them.
Volume<float> noisyImage(int size) {
  Volume<float> image(cube(size));
  std::mt19937 generator(3);
  std::uniform_int_distribution<int> grey(20, 200);
  for (float& value : image.data) value = static_cast<float>(grey(generator));
  return image;
}

/// Blocks of eight voxels a side, each with a label of its own.
Volume<float> blocks(int size) {
  Volume<float> image(cube(size));
  for (std::size_t v = 0; v < image.size(); ++v) {
    const auto [i, j, k] = image.grid.subscripts(v);
    image[v] = static_cast<float>(1 + i / 8 + 10 * (j / 8) + 100 * (k / 8));
  }
  return image;
}

template <class To, class From>
Volume<To> converted(const Volume<From>& volume) {
  Volume<To> result(volume.grid);
  for (std::size_t v = 0; v < volume.size(); ++v) result[v] = static_cast<To>(volume[v]);
  return result;
}

TEST(Plausibility, EveryLimitHasAnOwnNameARangeAndASource) {
  std::set<std::string_view> names;
  for (const Limit& limit : limits()) {
    EXPECT_TRUE(names.insert(limit.name).second) << limit.name;
    EXPECT_LT(limit.low, limit.high) << limit.name;
    EXPECT_FALSE(limit.source.empty()) << limit.name;
    EXPECT_FALSE(limit.remedy.empty()) << limit.name;
  }
}

TEST(Plausibility, LimitsThemselvesArePlausibleAndBeyondIsNot) {
  for (const Limit& limit : limits()) {
    EXPECT_FALSE(judge(limit.name, limit.low).has_value()) << limit.name;
    EXPECT_TRUE(judge(limit.name, limit.low - 0.1).has_value()) << limit.name;
    EXPECT_TRUE(judge(limit.name, kNaN).has_value()) << limit.name;
    if (!std::isfinite(limit.high)) continue;
    EXPECT_FALSE(judge(limit.name, limit.high).has_value()) << limit.name;
    EXPECT_TRUE(judge(limit.name, 1.01 * limit.high).has_value()) << limit.name;
  }
}

TEST(Plausibility, AFlagNamesItsNumberAndItsRange) {
  const auto flag = judge("brain-volume", 4152);
  ASSERT_TRUE(flag.has_value());
  EXPECT_EQ(flag->value, 4152);
  EXPECT_EQ(flag->low, 300);
  EXPECT_EQ(flag->high, 2500);
  EXPECT_FALSE(flag->accepted);
  EXPECT_NE(flag->sentence.find("4152 ml"), std::string::npos);
  EXPECT_NE(flag->sentence.find("300 to 2500 ml"), std::string::npos);
}

TEST(Plausibility, WhatIsAcceptedIsKeptAndMarked) {
  EXPECT_TRUE(judge("corrected", 1, {"corrected"})->accepted);
  EXPECT_FALSE(judge("corrected", 1, {"contrast"})->accepted);
  EXPECT_THROW(checkAccepted({"corrected", "korrected"}), InvalidInput);
}

TEST(Plausibility, TellsImagesFromLabels) {
  EXPECT_TRUE(looksLikeImage(converted<Label>(noisyImage(24))));
  EXPECT_FALSE(looksLikeLabels(noisyImage(24)));
  EXPECT_FALSE(looksLikeImage(converted<Label>(blocks(40))));
  EXPECT_TRUE(looksLikeLabels(blocks(40)));
  Volume<float> shares = blocks(40);
  for (float& value : shares.data) value /= 3;
  EXPECT_FALSE(looksLikeLabels(shares)) << "fractions are no labels";
}

TEST(Plausibility, KnowsTheAirOfACt) {
  Volume<float> ct = noisyImage(16);
  EXPECT_EQ(airInHounsfieldUnits(ct), 0);
  for (std::size_t v = 0; v < ct.size() / 2; ++v) ct[v] = -1000;
  EXPECT_EQ(airInHounsfieldUnits(ct), 0.5);
}

/// A ball of white matter in grey in fluid.
Volume<Label> ball() {
  Volume<Label> tissues(cube(40), 0);
  for (std::size_t v = 0; v < tissues.size(); ++v) {
    const auto [i, j, k] = tissues.grid.subscripts(v);
    const double r = (Vector(i, j, k) - Vector::Constant(19.5)).norm();
    if (r < 18) tissues[v] = r < 9 ? kWhite : (r < 14 ? kGrey : kCsf);
  }
  return tissues;
}

TEST(Plausibility, FluidLiesAtTheRimUnlessTheContrastIsInverted) {
  Volume<Label> tissues = ball();
  EXPECT_GT(rimContrast(tissues), 10);
  for (Label& label : tissues.data) {
    if (label != 0) label = kCsf + kWhite - label;
  }
  EXPECT_LT(rimContrast(tissues), 0.1);
  std::replace(tissues.data.begin(), tissues.data.end(), kWhite, kGrey);
  EXPECT_TRUE(std::isnan(rimContrast(tissues)));
}

TEST(Plausibility, ACortexThatEndsAtTheMaskIsTold) {
  Volume<Label> tissues(Grid{}, Label{0});
  tissues.grid.size = {12, 6, 6};
  tissues.grid.spacing = {1, 1, 2};
  tissues.data.assign(12 * 6 * 6, 0);
  for (int i = 2; i < 6; ++i) tissues(i, 3, 3) = 2;  // a rod: ends of 2 mm^2, four sides a voxel
  EXPECT_EQ(greyAtMaskEdge(tissues), 1);
  for (int i = 2; i < 6; ++i) tissues(i, 2, 3) = tissues(i, 4, 3) = 1;
  // Fluid: 2 x 4 faces of 2 mm^2.  Outside: 2 x 4 of 1 mm^2 and 2 ends of 2 mm^2.
  EXPECT_DOUBLE_EQ(greyAtMaskEdge(tissues), 12.0 / 28);
  // A brain that is stripped along its folds is worth a look, not doubted.
  TissueSummary summary;
  for (const double share : {0.49, 0.8}) {
    summary.greyAtMaskEdge = share;
    Results results;
    describe(results, summary);
    EXPECT_EQ(results["grey_at_mask_edge"].judgement(),
              share < 0.5 ? Judgement::Good : Judgement::Look);
  }
}

TEST(Plausibility, ABrainStrippedTightlyHasGreyMatterAtItsRim) {
  Volume<Label> tissues = ball();
  for (std::size_t v = 0; v < tissues.size(); ++v) {
    const auto [i, j, k] = tissues.grid.subscripts(v);
    if (tissues[v] == kCsf) tissues[v] = 0;
    if ((Vector(i, j, k) - Vector::Constant(19.5)).norm() < 3) tissues[v] = kCsf;
  }
  EXPECT_GT(rimContrast(tissues), 10) << "its only fluid is deep inside";
}

/// Twice the brightness at one end of the image, vessels of a share of white matter's brightness,
/// and brighter fat outside the brain.
std::pair<Volume<float>, TissueSegmentation> withVessels(double brightness) {
  TissueSegmentation tissue;
  tissue.labels = ball();
  const Grid& grid = tissue.labels.grid;
  tissue.bias = Volume<float>(grid, 1);
  Volume<float> image(grid, 300);
  const std::array<float, 4> means = {300, 30, 80, 100};
  tissue.classes[2].mean = means[kWhite];
  for (std::size_t v = 0; v < image.size(); ++v) {
    if (tissue.labels[v] == 0) continue;
    ++tissue.brainVoxels;
    tissue.bias[v] = static_cast<float>(std::exp2(grid.subscripts(v)[0] / 40.0));
    const bool isVessel = v % 50 == 0;
    image[v] = tissue.bias[v] *
               (isVessel ? static_cast<float>(100 * brightness) : means[tissue.labels[v]]);
  }
  return {image, tissue};
}

TEST(Plausibility, VesselsWithContrastAgentAreTold) {
  const auto [image, tissue] = withVessels(1.3);
  EXPECT_NEAR(brighterThanWhite(image, tissue), 1.0 / 50, 2e-3);
  EXPECT_TRUE(judge("bright-in-brain", brighterThanWhite(image, tissue)));
  const auto [plain, asBright] = withVessels(1.1);
  EXPECT_EQ(brighterThanWhite(plain, asBright), 0);
}

TEST(FreeSurferAtlas, IsNotAnAtlasThatCountsFromOne) {
  Volume<Label> aal(cube(5), 0);
  for (Label n = 1; n <= 116; ++n) aal[static_cast<std::size_t>(n)] = n;
  EXPECT_FALSE(isFreeSurferAtlas(aal)) << "AAL has 2, 3, 41 and 42 too";
}

TEST(FreeSurferAtlas, IsKnownByItsLabels) {
  Volume<Label> atlas(cube(4), 0);
  EXPECT_FALSE(isFreeSurferAtlas(atlas));
  atlas[0] = 2;
  atlas[1] = 41;
  atlas[2] = 1022;
  EXPECT_FALSE(isFreeSurferAtlas(atlas)) << "no right cortex";
  atlas[3] = 2022;
  EXPECT_TRUE(isFreeSurferAtlas(atlas));
  atlas[4] = 24;  // fluid belongs to no side
  keepNamed(atlas, freeSurferLegend());
  EXPECT_EQ(atlas[3], 2022);
  EXPECT_EQ(atlas[4], 0);
  const AtlasLegend legend = freeSurferLegend();
  EXPECT_EQ(legend.at(2022).side, Side::Right);
  EXPECT_EQ(legend.at(10).kind, StructureKind::Deep);
  EXPECT_EQ(legend.at(16).kind, StructureKind::BelowTent);
}

}  // namespace
}  // namespace explica::segmentation
