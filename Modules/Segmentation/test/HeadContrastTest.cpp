// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/HeadContrast.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::segmentation {
namespace {

/// A ball of 60 mm: fluid in the middle and at the rim, white matter, cortex, two vessels.
Volume<float> brain(float fluid, float grey, float white, float vessel) {
  Grid grid;
  grid.size = {47, 47, 47};
  grid.spacing = Vector::Constant(3);
  Volume<float> image(grid, 0.0f);
  for (std::size_t v = 0; v < image.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const Vector p = 3 * (Vector(i, j, k) - Vector::Constant(23));
    const double r = p.norm();
    if (r > 60) continue;
    image[v] = r < 14 || r > 57 ? fluid : (r > 50 || p.x() > 20 ? grey : white);
    const bool inVessel = std::abs(p.y() - 18) < 2 && std::abs(std::abs(p.z()) - 9) < 2;
    if (inVessel && r < 40) image[v] = vessel;
  }
  return image;
}

TEST(HeadContrast, FluidIsTheDarkTailOfAT1AndTheBrightOneOfAT2) {
  const HeadContrast t1 = measureContrast(brain(30, 70, 110, 60));
  EXPECT_LT(t1.skewness, 0);
  EXPECT_GT(t1.spread, 0.25);
  EXPECT_LT(t1.brightest, 1.3);
  EXPECT_EQ(t1.brightShare, 0);
  const HeadContrast t2 = measureContrast(brain(200, 85, 60, 60));
  EXPECT_GT(t2.skewness, 0.2);
  EXPECT_GT(t2.brightShare, 0.05);
}

TEST(HeadContrast, VesselsAreFewAndFarBrighterThanTheRest) {
  const HeadContrast angiogram = measureContrast(brain(60, 62, 64, 250));
  EXPECT_GT(angiogram.brightest, 2.3);
  EXPECT_LT(angiogram.brightShare, 0.05);
}

TEST(HeadContrast, AProtonDensityImageHasLittleOfItAndNoDarkTail) {
  const HeadContrast found = measureContrast(brain(125, 128, 112, 115));
  EXPECT_LT(found.spread, 0.25);
  EXPECT_GT(found.skewness, 0.1);
}

TEST(HeadContrast, AT1WhoseCoilIsOnOneSideIsNoT2) {
  Volume<float> image = brain(30, 70, 110, 60);
  for (std::size_t v = 0; v < image.size(); ++v) {
    const double across = image.grid.subscripts(v)[0] - 23.0;
    image[v] *= static_cast<float>(std::exp(0.08 * across));
  }
  const HeadContrast even = measureContrast(brain(30, 70, 110, 60)), found = measureContrast(image);
  EXPECT_LT(found.skewness, 0);
  EXPECT_NEAR(found.skewness, even.skewness, 0.15);
  EXPECT_LT(found.brightest, 1.3);
}

TEST(HeadContrast, DoesNotDependOnTheUnitOfBrightness) {
  const HeadContrast one = measureContrast(brain(30, 70, 110, 60));
  const HeadContrast other = measureContrast(brain(3000, 7000, 11000, 6000));
  EXPECT_NEAR(one.skewness, other.skewness, 1e-5);
  EXPECT_NEAR(one.spread, other.spread, 1e-5);
}

TEST(HeadContrast, OfNothingIsNothing) {
  Grid grid;
  grid.size = {8, 8, 2};
  grid.spacing = Vector(1, 1, 10);
  const HeadContrast found = measureContrast(Volume<float>(grid, 0.0f));
  EXPECT_EQ(found.thickest, 10);
  EXPECT_EQ(found.spread, 0);
}

TEST(CountFromAir, IsWhatTheDarkestHundredthIsButInACt) {
  Grid grid;
  grid.size = {10, 10, 10};
  Volume<float> image(grid, -0.75f);
  for (std::size_t v = 0; v < 300; ++v) image[v] = 0.01f * static_cast<float>(v);
  image[999] = -2;  // an undershoot
  EXPECT_EQ(countFromAir(image), 0.75f);
  EXPECT_EQ(image[998], 0);
  EXPECT_EQ(image[999], 0);
  EXPECT_FLOAT_EQ(image[100], 1.75f);
  EXPECT_EQ(countFromAir(image), 0);
  Volume<float> ct(grid, -1000.0f);
  EXPECT_EQ(countFromAir(ct), 0);
  EXPECT_EQ(ct[0], -1000);
}

TEST(CountFromAir, IsZeroAroundAStrippedBrainThatWasInterpolated) {
  Grid grid;
  grid.size = {10, 10, 10};
  Volume<float> image(grid, 0.0f);
  for (std::size_t v = 0; v < 200; ++v) image[v] = 100;
  for (std::size_t v = 200; v < 250; ++v) image[v] = -4;  // its undershoots
  for (std::size_t v = 250; v < 500; ++v) image[v] = v % 2 == 0 ? 1e-5f : -1e-5f;
  EXPECT_EQ(countFromAir(image), 0);
  EXPECT_EQ(image[100], 100);
  for (const std::size_t outside : {220, 300, 301, 900}) EXPECT_EQ(image[outside], 0) << outside;
}

TEST(CountFromAir, KeepsTheDarkHalfOfABrainThatWasScaledWithinItsMask) {
  Grid grid;
  grid.size = {10, 10, 10};
  Volume<float> image(grid, 0.0f);
  for (std::size_t v = 0; v < 300; ++v) image[v] = -2.4f + 0.0123f * static_cast<float>(v);
  EXPECT_FLOAT_EQ(countFromAir(image), 2.4f);
  for (std::size_t v = 1; v < 300; ++v) ASSERT_NEAR(image[v], 0.0123f * v, 1e-5) << v;
  for (std::size_t v = 300; v < 1000; ++v) ASSERT_EQ(image[v], 0) << v;
}

}  // namespace
}  // namespace explica::segmentation
