// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/Tissue.h"

#include "../src/BorderLevels.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Segmentation/Plausibility.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>

namespace explica::segmentation {
namespace {

/// Concentric balls of white, grey and fluid, with noise and a multiplicative ramp along x; voxels
/// on a border hold the mixture of their tissues.
struct Phantom {
  Volume<float> image;
  Volume<Label> truth;
};

Phantom makePhantom(double noise, double ramp, const Vector& spacing = Vector::Ones()) {
  Grid grid;
  grid.spacing = spacing;
  const double extent = 60;
  for (int a = 0; a < 3; ++a) grid.size[a] = static_cast<int>(extent / spacing[a]);
  Phantom phantom{Volume<float>(grid, 0.0f), Volume<Label>(grid, 0)};
  std::mt19937 generator(7);
  std::normal_distribution<double> gauss(0, 1);
  const auto share = [](double inside) { return std::clamp(0.5 + inside, 0.0, 1.0); };
  for (std::size_t v = 0; v < phantom.image.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const Point p = grid.toWorld(Vector(i, j, k)) - Point::Constant(extent / 2);
    const double r = p.norm();
    if (r > 28) continue;
    const double white = share(16 - r);
    const double grey = share(22 - r) - white;
    const double csf = 1 - white - grey;
    phantom.truth[v] = white > 0.5 ? kWhite : (csf > 0.5 ? kCsf : kGrey);
    const double clean = 35 * csf + 85 * grey + 115 * white;
    phantom.image[v] = static_cast<float>(
        std::max(1.0, (clean + noise * gauss(generator)) * (1 + ramp * p.x() / 28)));
  }
  return phantom;
}

double agreement(const Volume<Label>& found, const Volume<Label>& truth) {
  std::size_t same = 0;
  std::size_t all = 0;
  for (std::size_t v = 0; v < truth.size(); ++v) {
    if (truth[v] == 0) continue;
    ++all;
    same += found[v] == truth[v];
  }
  return static_cast<double>(same) / static_cast<double>(all);
}

TEST(TissueSegmentation, FindsThreeTissuesInNoise) {
  const Phantom phantom = makePhantom(4, 0);
  const TissueSegmentation found = segmentTissue(phantom.image);
  EXPECT_EQ(found.termination, Termination::Converged);
  EXPECT_GT(agreement(found.labels, phantom.truth), 0.98);
  EXPECT_NEAR(found.classes[0].mean, 35, 2);
  EXPECT_NEAR(found.classes[1].mean, 85, 2);
  EXPECT_NEAR(found.classes[2].mean, 115, 2);
}

// Noise of a third of the contrast of grey and white matter: neighbours tell what a voxel cannot.
TEST(TissueSegmentation, FindsThreeTissuesInStrongNoise) {
  const Phantom phantom = makePhantom(11, 0);
  EXPECT_GT(agreement(segmentTissue(phantom.image).labels, phantom.truth), 0.9);
}

TEST(TissueSegmentation, ATightMaskMakesNoFluidOfGreyMattersNoise) {
  // All fluid that is left is a ventricle's.
  Phantom phantom = makePhantom(9, 0);
  const Grid& grid = phantom.image.grid;
  const auto share = [](double inside) { return std::clamp(0.5 + inside, 0.0, 1.0); };
  std::size_t grey = 0, fluid = 0;
  for (std::size_t v = 0; v < phantom.image.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const double r = (grid.toWorld(Vector(i, j, k)) - Point::Constant(30)).norm();
    phantom.image[v] -= static_cast<float>(80 * share(3 - r));
    if (r > 21) phantom.image[v] = 0;
  }
  const TissueSegmentation found = segmentTissue(phantom.image);
  for (std::size_t v = 0; v < phantom.image.size(); ++v) {
    if (phantom.image[v] <= 0 || phantom.truth[v] != kGrey) continue;
    ++grey;
    fluid += found.labels[v] == kCsf;
  }
  EXPECT_LT(static_cast<double>(fluid), 0.01 * static_cast<double>(grey));
}

// The extremes of white matter's noise are no grey matter, or the border's level climbs.
TEST(TissueSegmentation, WhiteMattersBorderStaysOutOfItsNoise) {
  for (const Vector& spacing : {Vector(1, 1, 1), Vector(1, 1, 2)}) {
    const Phantom phantom = makePhantom(7, 0, spacing);
    const TissueSegmentation found = segmentTissue(phantom.image);
    std::size_t deep = 0, grey = 0;
    for (std::size_t v = 0; v < phantom.truth.size(); ++v) {
      const auto [i, j, k] = phantom.truth.grid.subscripts(v);
      if ((phantom.truth.grid.toWorld(Vector(i, j, k)) - Point::Constant(30)).norm() > 13) continue;
      ++deep;
      grey += found.labels[v] == kGrey;
    }
    EXPECT_LT(static_cast<double>(grey), 0.03 * static_cast<double>(deep)) << spacing.transpose();
  }
}

TEST(TissueSegmentation, TellsTheNoise) {
  for (const double noise : {3.0, 12.0}) {
    const TissueSegmentation found = segmentTissue(makePhantom(noise, 0.1).image);
    EXPECT_NEAR(found.noise, noise, 0.15 * noise);
    EXPECT_EQ(judge("noise", noiseOfContrast(found), {}).has_value(), noise > 10);
  }
}

// Without fluid the darkest class has hardly a voxel of its own, and its mean comes to rest late.
TEST(TissueSegmentation, ComesToRestWhereAMaskLeavesNoFluid) {
  Phantom phantom = makePhantom(12, 0);
  for (std::size_t v = 0; v < phantom.image.size(); ++v) {
    if (phantom.truth[v] == kCsf) phantom.image[v] = 0;
  }
  EXPECT_EQ(segmentTissue(phantom.image).termination, Termination::Converged);
}

TEST(TissueSegmentation, KnowsPureFluidByAVentricle) {
  Phantom phantom = makePhantom(4, 0.1);
  const Grid& grid = phantom.image.grid;
  const auto share = [](double inside) { return std::clamp(0.5 + inside, 0.0, 1.0); };
  for (std::size_t v = 0; v < phantom.image.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const double r = (grid.toWorld(Vector(i, j, k)) - Point::Constant(30)).norm();
    const double dura = share(24 - r) - share(23 - r);  // leaves 1 mm of fluid on both sides
    phantom.image[v] += static_cast<float>(35 * dura - 80 * share(5 - r));
    if (r > 25) phantom.image[v] = 0;
  }
  const TissueSegmentation found = segmentTissue(phantom.image);
  EXPECT_NEAR(found.deepFluid, 35, 3);
  EXPECT_GT(found.classes[0].mean, 39);
}

TEST(TissueSegmentation, ToleratesABiasField) {
  const Phantom phantom = makePhantom(3, 0.25);
  TissueOptions without;
  without.biasWidth = 0;
  without.localWidth = 0;  // edges' own brightness would make up for most of it
  const double flat = agreement(segmentTissue(phantom.image, {}, without).labels, phantom.truth);
  TissueOptions with;
  with.biasWidth = 15;  // the phantom is a third of a head across
  const TissueSegmentation found = segmentTissue(phantom.image, {}, with);
  EXPECT_GT(agreement(found.labels, phantom.truth), 0.97);
  EXPECT_GT(agreement(found.labels, phantom.truth), flat + 0.01);
}

/// Smooth shapes from -1 to 1 over the phantom.
double shapeAt(int shape, const Point& p) {
  if (shape == 0) return p.x();
  if (shape == 1) return std::sin(1.6 * p.y() + 0.4 * p.z());
  return p.x() * p.y() + 0.5 * p.z();
}

class StrongField : public ::testing::TestWithParam<int> {};

TEST_P(StrongField, IsFoundAndCostsLittle) {
  const Phantom flat = makePhantom(3, 0);
  TissueOptions options;
  options.biasWidth = 15;  // the phantom is a third of a head across
  const double before = agreement(segmentTissue(flat.image, {}, options).labels, flat.truth);
  Phantom shaded = flat;
  std::vector<double> truth(shaded.image.size(), 0.0);
  for (std::size_t v = 0; v < truth.size(); ++v) {
    if (flat.truth[v] == 0) continue;
    const auto [i, j, k] = flat.image.grid.subscripts(v);
    const Point p = (flat.image.grid.toWorld(Vector(i, j, k)) - Point::Constant(30)) / 28;
    const double field = 1 + 0.4 * std::clamp(shapeAt(GetParam(), p), -1.0, 1.0);
    truth[v] = std::log(field);
    shaded.image[v] *= static_cast<float>(field);
  }
  const TissueSegmentation found = segmentTissue(shaded.image, {}, options);
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t v = 0; v < truth.size(); ++v) {
    if (flat.truth[v] == 0) continue;
    const double log = std::log(found.bias[v]);
    n += 1;
    x += truth[v];
    y += log;
    xx += truth[v] * truth[v];
    xy += truth[v] * log;
  }
  EXPECT_GT((n * xy - x * y) / (n * xx - x * x), 0.9);
  EXPECT_GT(agreement(found.labels, flat.truth), before - 0.02);
}

INSTANTIATE_TEST_SUITE_P(TissueSegmentation, StrongField, ::testing::Range(0, 3));

TEST(TissueSegmentation, WorksOnAnisotropicVoxels) {
  const Phantom phantom = makePhantom(4, 0, Vector(0.8, 1, 2.5));
  EXPECT_GT(agreement(segmentTissue(phantom.image).labels, phantom.truth), 0.97);
}

TEST(TissueSegmentation, SharesSumToOneInsideAndZeroOutside) {
  const Phantom phantom = makePhantom(4, 0);
  const TissueSegmentation found = segmentTissue(phantom.image);
  for (std::size_t v = 0; v < phantom.truth.size(); ++v) {
    const float sum = found.probability[0][v] + found.probability[1][v] + found.probability[2][v];
    ASSERT_NEAR(sum, phantom.truth[v] == 0 ? 0 : 1, 1e-5);
  }
}

TEST(TissueSegmentation, BorderSharesAreSubVoxel) {
  const Phantom phantom = makePhantom(0.5, 0);
  const TissueSegmentation found = segmentTissue(phantom.image);
  // Along +x from the centre the white share must cross one half at radius 16.
  const int c = phantom.image.grid.size[1] / 2;
  double crossing = 0;
  for (int i = c; i + 1 < phantom.image.grid.size[0]; ++i) {
    const double a = found.probability[2](i, c, c);
    const double b = found.probability[2](i + 1, c, c);
    if (a >= 0.5 && b < 0.5) crossing = i + (a - 0.5) / (a - b) - c;
  }
  EXPECT_NEAR(crossing, 16, 0.25);
}

/// How far outside of its place, radius 16, the white border lies on one side of x, mm.
double whiteShift(const TissueSegmentation& found, bool right) {
  double volume = 0, truth = 0;
  for (std::size_t v = 0; v < found.labels.size(); ++v) {
    const auto [i, j, k] = found.labels.grid.subscripts(v);
    const Point p = found.labels.grid.toWorld(Vector(i, j, k)) - Point::Constant(30);
    if ((p.x() > 0) != right || p.x() == 0 || p.norm() > 18.5) continue;
    volume += found.probability[2][v];
    truth += std::clamp(0.5 + 16 - p.norm(), 0.0, 1.0);
  }
  return (volume - truth) / (2 * kPi * 16 * 16);
}

TEST(TissueSegmentation, BordersFollowTissueThatIsBrighterInPlaces) {
  Phantom phantom = makePhantom(0.5, 0);
  for (std::size_t v = 0; v < phantom.image.size(); ++v) {
    const auto [i, j, k] = phantom.image.grid.subscripts(v);
    const Point p = phantom.image.grid.toWorld(Vector(i, j, k)) - Point::Constant(30);
    const double white = std::clamp(0.5 + 16 - p.norm(), 0.0, 1.0);
    const double tissue = std::clamp(0.5 + 22 - p.norm(), 0.0, 1.0);
    // As myelin does: grey matter from 85 on the left to 97 on the right.
    const double more = 12 / (1 + std::exp(-p.x() / 3));
    phantom.image[v] += static_cast<float>(more * (tissue - white));
  }
  const auto worst = [&](double localWidth) {
    TissueOptions options;
    options.biasWidth = 0;
    options.localWidth = localWidth;
    const TissueSegmentation found = segmentTissue(phantom.image, {}, options);
    return std::max(std::abs(whiteShift(found, true)), std::abs(whiteShift(found, false)));
  };
  const double followed = worst(4), everywhere = worst(0);
  EXPECT_LT(followed, 0.1);
  EXPECT_GT(everywhere, 2 * followed);
}

TEST(BorderFinder, LearnsTheWhiteBordersLevelNearAMasksEdge) {
  // White matter of 120 beside cortex of 84, blurred by 0.6 voxels; means are 116 and 80 elsewhere.
  Grid grid;
  grid.size = {12, 12, 12};
  std::vector<std::size_t> voxel(grid.voxelCount());
  std::vector<std::array<std::int32_t, 6>> neighbours(voxel.size());
  std::vector<float> intensity(voxel.size());
  const std::vector<std::uint8_t> rim(voxel.size(), 1);  // a mask follows the cortex
  for (std::size_t v = 0; v < voxel.size(); ++v) {
    voxel[v] = v;
    const auto at = grid.subscripts(v);
    for (int n = 0; n < 6; ++n) {
      auto next = at;
      next[n / 2] += n % 2 == 0 ? -1 : 1;
      neighbours[v][n] = grid.contains(next[0], next[1], next[2])
                             ? static_cast<std::int32_t>(grid.linear(next[0], next[1], next[2]))
                             : -1;
    }
    const double way = (at[0] - 5.5) / (0.6 * std::sqrt(2.0));
    intensity[v] = static_cast<float>(102 + 18 * std::erf(way));
  }
  const EdgeSamples samples{&voxel,     &neighbours,  &rim,
                            &intensity, grid.spacing, std::vector<std::uint8_t>(voxel.size(), 0)};
  const BlockWindow window(grid, voxel, 4, 2);
  BorderFinder finder(window, samples, {20, 80, 116});
  for (int round = 0; round < 10; ++round) finder.improve();
  double sum = 0;
  for (const float level : finder.levels().white) sum += level;
  EXPECT_NEAR(sum / static_cast<double>(voxel.size()), 102, 1) << "half way between the means: 98";
  for (const float level : finder.levels().outer) EXPECT_EQ(level, 50) << "no fluid is seen";
}

TEST(TissueSegmentation, DarkRemainsAtTheBrainsEdgeAreNotFluid) {
  Phantom phantom = makePhantom(3, 0);
  for (std::size_t v = 0; v < phantom.image.size(); ++v) {
    const auto [i, j, k] = phantom.image.grid.subscripts(v);
    const double r = (phantom.image.grid.toWorld(Vector(i, j, k)) - Point::Constant(30)).norm();
    if (r > 26.8 && phantom.image[v] > 0) phantom.image[v] = 2;
  }
  EXPECT_NEAR(segmentTissue(phantom.image).classes[0].mean, 35, 4);
}

// Skull stripping leaves fat of the orbit: neither it is tissue, nor what it shares with fluid.
TEST(TissueSegmentation, FatBesideTheBrainIsNoTissue) {
  for (const Vector& spacing : {Vector(1, 1, 1), Vector(1, 1, 2)}) {
    Phantom phantom = makePhantom(3, 0.1, spacing);
    const Point middle(57, 30, 30);
    std::size_t fat = 0, tissue = 0;
    std::vector<std::size_t> near;
    for (std::size_t v = 0; v < phantom.image.size(); ++v) {
      const auto [i, j, k] = phantom.image.grid.subscripts(v);
      const double apart = (phantom.image.grid.toWorld(Vector(i, j, k)) - middle).norm();
      const double share = std::clamp(4.5 - apart, 0.0, 1.0);
      if (phantom.image[v] <= 0) continue;
      phantom.image[v] += static_cast<float>(share * (220 - phantom.image[v]));
      if (apart < 6 && phantom.truth[v] == kCsf) near.push_back(v);
      fat += share > 0.5 ? 1 : 0;
    }
    const TissueSegmentation found = segmentTissue(phantom.image);
    for (const std::size_t v : near) tissue += found.labels[v] == kCsf ? 0 : 1;
    EXPECT_LT(static_cast<double>(tissue), 0.1 * static_cast<double>(fat)) << spacing.transpose();
    EXPECT_GT(agreement(found.labels, phantom.truth), 0.98);
    EXPECT_NEAR(found.classes[2].mean, 115, 2) << "nor does it count as white matter";
  }
}

/// The phantom moved by half a voxel along each axis: each voxel the mean of eight.
Volume<float> movedByHalf(const Volume<float>& image) {
  Volume<float> moved(image.grid, 0.0f);
  for (std::size_t v = 0; v < image.size(); ++v) {
    const auto [i, j, k] = image.grid.subscripts(v);
    for (int c = 0; c < 8; ++c) {
      const int a = i + (c & 1), b = j + (c >> 1 & 1), d = k + (c >> 2);
      if (image.grid.contains(a, b, d)) moved[v] += image(a, b, d) / 8;
    }
  }
  return moved;
}

TEST(TissueSegmentation, EmptySpaceThatResamplingBlendsInDoesNotDarkenFluid) {
  const Phantom phantom = makePhantom(3, 0);
  const Volume<float> moved = movedByHalf(phantom.image);
  const TissueSegmentation found = segmentTissue(moved);
  EXPECT_NEAR(found.classes[0].mean, 35, 2);
  std::int64_t brain = 0, named = 0;
  double shares = 0;
  for (std::size_t v = 0; v < moved.size(); ++v) {
    brain += moved[v] > 0 ? 1 : 0;
    named += found.labels[v] != 0 ? 1 : 0;
    if (moved[v] > 0 && moved[v] < 10) {
      EXPECT_EQ(found.labels[v], kCsf);
    }
  }
  for (const auto& tissue : found.classes) shares += tissue.share;
  EXPECT_EQ(named, brain);  // nothing is dropped
  EXPECT_EQ(found.brainVoxels, brain);
  EXPECT_NEAR(shares, 1, 1e-5);
}

TEST(TissueSegmentation, DoesNotDependOnThreads) {
  const Phantom phantom = makePhantom(5, 0.1);
  setThreadCount(1);
  const TissueSegmentation one = segmentTissue(phantom.image);
  setThreadCount(4);
  const TissueSegmentation four = segmentTissue(phantom.image);
  setThreadCount(0);
  EXPECT_EQ(std::memcmp(one.probability[1].data.data(), four.probability[1].data.data(),
                        one.probability[1].size() * sizeof(float)),
            0);
}

TEST(TissueSegmentation, RefusesWhatIsNotABrain) {
  Phantom phantom = makePhantom(4, 0);
  EXPECT_THROW((void)segmentTissue(Volume<float>(phantom.image.grid, 0.0f)), InvalidInput);
  EXPECT_THROW((void)segmentTissue(Volume<float>(phantom.image.grid, 1.0f)), InvalidInput);
  phantom.image[phantom.image.size() / 2] = std::nanf("");
  EXPECT_THROW((void)segmentTissue(phantom.image), InvalidInput);
}

}  // namespace
}  // namespace explica::segmentation
