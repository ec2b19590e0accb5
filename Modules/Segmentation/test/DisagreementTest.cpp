// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/Disagreement.h"

#include "Explica/Core/Errors.h"
#include "Explica/Segmentation/Tissue.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::segmentation {
namespace {

/// White within grey, and within the white a ball of what is asked for.
struct Head {
  Volume<Label> tissues;
  Volume<float> expected;
};

Head makeHead(double lesion, Label tissue) {
  Grid grid;
  grid.size = {50, 50, 50};
  grid.origin = Point::Constant(-24.5);
  Head head{Volume<Label>(grid, 0), Volume<float>(grid, 0.0f)};
  for (std::size_t v = 0; v < head.tissues.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const Point at = grid.toWorld(Vector(i, j, k));
    const double r = at.norm();
    if (r > 23) continue;
    head.tissues[v] = r > 18 ? kGrey : kWhite;
    head.expected[v] = r > 18 ? 80 : 110;
    if ((at - Point(5, 0, 0)).norm() < lesion) head.tissues[v] = tissue;
  }
  return head;
}

TEST(Disagreement, IsTheLesionsVolume) {
  for (const Label tissue : {kCsf, kGrey}) {
    const Head head = makeHead(6, tissue);
    const Disagreement found = whiteDisagreement(head.tissues, head.expected);
    EXPECT_NEAR(found.largest, 4.0 / 3 * kPi * 216, 30);
    EXPECT_GT(found.share, 0.05);
    EXPECT_EQ(static_cast<double>(found.voxels), found.largest);
    EXPECT_NEAR(found.deepest, 6, 1);
    EXPECT_LT((found.middle - Point(5, 0, 0)).norm(), 1.5);
    const Head small = makeHead(3, tissue);  // 0.1 ml
    EXPECT_EQ(whiteDisagreement(small.tissues, small.expected).voxels, 0);
  }
}

TEST(Disagreement, ABorderThatIsOffByAVoxelOrTwoDoesNotCount) {
  Head head = makeHead(0, kCsf);
  for (std::size_t v = 0; v < head.tissues.size(); ++v) {
    const auto [i, j, k] = head.tissues.grid.subscripts(v);
    const double r = head.tissues.grid.toWorld(Vector(i + 2, j, k)).norm();
    if (head.tissues[v] != 0) head.tissues[v] = r > 18 ? kGrey : kWhite;
  }
  const Disagreement found = whiteDisagreement(head.tissues, head.expected);
  EXPECT_EQ(found.largest, 0);
  EXPECT_EQ(found.share, 0);
}

TEST(Disagreement, WhatIsThinnerThanALesionDoesNotCount) {
  Head head = makeHead(0, kCsf);
  for (std::size_t v = 0; v < head.tissues.size(); ++v) {
    const auto [i, j, k] = head.tissues.grid.subscripts(v);
    const Point at = head.tissues.grid.toWorld(Vector(i, j, k));
    if (head.tissues[v] == kWhite && std::abs(at.x()) < 3.5) head.tissues[v] = kCsf;
  }
  const Disagreement found = whiteDisagreement(head.tissues, head.expected);
  EXPECT_GT(found.largest, 2000);
  EXPECT_LT(found.deepest, 5);
  EXPECT_EQ(found.voxels, 0);
}

TEST(Disagreement, VolumesMustShareAGrid) {
  Head head = makeHead(0, kCsf);
  head.expected.grid.origin.x() += 1;
  EXPECT_THROW((void)whiteDisagreement(head.tissues, head.expected), InvalidInput);
}

}  // namespace
}  // namespace explica::segmentation
