// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/HeartLabels.h"

#include "Explica/Core/Errors.h"
#include "Explica/Phantom/BeatingVentricle.h"

#include <gtest/gtest.h>

using namespace explica;
using namespace explica::ventricle;

namespace {

Volume<Label> heart() {
  return phantom::beatingVentricle({90, 1.4}, {.frames = 1, .slice = 8}).frames[0].labels;
}

Volume<Label> renamed(Volume<Label> labels, Label cavity, Label wall, Label right) {
  for (Label& l : labels.data) l = l == 1 ? cavity : l == 2 ? wall : l == 3 ? right : 0;
  return labels;
}

}  // namespace

TEST(HeartLabels, TheEnclosedLabelTellsTheConvention) {
  const Volume<Label> mms = heart(), acdc = renamed(mms, 3, 2, 1);
  EXPECT_EQ(findRoles({mms}).how, "mms or ukbb");
  EXPECT_EQ(findRoles({acdc}).how, "acdc");
  EXPECT_EQ(relabelled(acdc, findRoles({acdc})).data, mms.data);
  EXPECT_EQ(findRoles({renamed(mms, 3, 2, 0)}).cavity, 3);
  EXPECT_FALSE(findRoles({renamed(mms, 1, 2, 0)}).right.has_value());
  // A frame in which nobody drew the wall says nothing about what encloses what.
  EXPECT_EQ(findRoles({renamed(mms, 1, 2, 0), renamed(mms, 1, 0, 0)}).cavity, 1);
}

TEST(HeartLabels, PiecesApartFromTheVentricleAreTakenOut) {
  const Volume<Label> whole = heart();
  Volume<Label> stray = whole;
  const int middle = whole.grid.size[2] / 2;
  stray(0, 0, middle) = stray(1, 0, middle) = kCavity;
  stray(0, 5, middle) = kWall;
  EXPECT_EQ(takeOutIslands(stray), 3);
  EXPECT_EQ(stray.data, whole.data);
  Volume<Label> cavityAlone = renamed(whole, kCavity, kOutside, kRight);
  EXPECT_EQ(takeOutIslands(cavityAlone), 0);
}

TEST(HeartLabels, PresetsAndNumbersOverrideIt) {
  const Volume<Label> mms = heart();
  EXPECT_EQ(findRoles({mms}, {.preset = Preset::Acdc}).cavity, 3);
  HeartLabelOptions given;
  given.cavity = 5;
  given.wall = 7;
  const HeartRoles roles = findRoles({renamed(mms, 5, 7, 9)}, given);
  EXPECT_EQ(roles.wall, 7);
  EXPECT_EQ(relabelled(renamed(mms, 5, 7, 0), roles).data, renamed(mms, 1, 2, 0).data);
}

TEST(HeartLabels, WhatIsNotClearIsRefusedWithTheRemedy) {
  const Volume<Label> mms = heart();
  const auto sentence = [](const Volume<Label>& labels, const HeartLabelOptions& options) {
    try {
      (void)findRoles({labels}, options);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_NE(sentence(renamed(mms, 10, 20, 30), {}).find("--preset"), std::string::npos);
  Volume<Label> image = mms;
  for (std::size_t n = 0; n < image.data.size(); ++n) image.data[n] = static_cast<Label>(n % 900);
  const std::string taken = sentence(image, {});
  EXPECT_NE(taken.find("887 more (is this an image?)"), std::string::npos) << taken;
  EXPECT_LT(taken.size(), 250U);
  EXPECT_NE(sentence(renamed(mms, 1, 0, 0), {}).find("no frame has a wall"), std::string::npos);
  EXPECT_NE(sentence(mms, {.preset = Preset::None}).find("--cavity"), std::string::npos);
  HeartLabelOptions same;
  same.cavity = same.wall = 2;
  EXPECT_NE(sentence(mms, same).find("different"), std::string::npos);
  HeartLabelOptions absent;
  absent.right = 8;
  EXPECT_NE(sentence(mms, absent).find("8"), std::string::npos);
}
