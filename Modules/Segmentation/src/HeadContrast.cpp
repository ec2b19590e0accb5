// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/HeadContrast.h"

#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/VoxelSets.h"
#include "Explica/Segmentation/Plausibility.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

namespace explica::segmentation {
namespace {

constexpr double kCube = 3;           // mm: noise and thin tissue matter less
constexpr float kTissue = 0.25f;      // of the mean of what is brighter than the mean
constexpr double kInner = 0.5;        // of the deepest point's distance to the air
constexpr double kBright = 1.8;       // medians
constexpr std::size_t kFewest = 800;  // cubes: what is smaller is no head, and not judged

/// Means over blocks of whole voxels, about so many mm a side, with a border of air.
Volume<float> inBlocks(const Volume<float>& image, double side) {
  std::array<int, 3> step;
  Grid grid = image.grid;
  for (int a = 0; a < 3; ++a) {
    step[a] = std::max(1, static_cast<int>(std::lround(side / grid.spacing[a])));
    grid.size[a] = grid.size[a] / step[a] + 2;
    grid.spacing[a] *= step[a];
  }
  Volume<float> blocks(grid, 0.0f);
  const float share = 1.0f / static_cast<float>(step[0] * step[1] * step[2]);
  for (std::size_t v = 0; v < image.size(); ++v) {
    const auto [i, j, k] = image.grid.subscripts(v);
    const int bi = i / step[0] + 1, bj = j / step[1] + 1, bk = k / step[2] + 1;
    if (bi + 1 < grid.size[0] && bj + 1 < grid.size[1] && bk + 1 < grid.size[2]) {
      blocks(bi, bj, bk) += share * image[v];
    }
  }
  return blocks;
}

float meanAbove(const Volume<float>& image, float least) {
  double sum = 0, count = 0;
  for (const float value : image.data) {
    if (!(value > least)) continue;
    sum += value;
    count += 1;
  }
  return count > 0 ? static_cast<float>(sum / count) : least;
}

/// The dark that is connected with the grid's corner.
VoxelSet airOf(const Volume<float>& blocks) {
  const float tissue = kTissue * meanAbove(blocks, meanAbove(blocks, -kInfinity));
  const Components parts =
      componentsOf(setWhere(blocks.grid, [&](std::size_t v) { return !(blocks[v] > tissue); }));
  return setWhere(blocks.grid, [&](std::size_t v) {
    return parts.number[v] >= 0 && parts.number[v] == parts.number[0];
  });
}

/// Divides by the exponential of the plane that fits the logarithms best: a coil on one side of the
/// head looks like a tail of brightness.
void divideByTrend(const Grid& grid, const std::vector<std::size_t>& voxels,
                   std::vector<float>& values) {
  Eigen::Matrix4d products = Eigen::Matrix4d::Zero();
  Eigen::Vector4d sums = Eigen::Vector4d::Zero();
  const auto placeOf = [&](std::size_t v) {
    const auto [i, j, k] = grid.subscripts(v);
    return Eigen::Vector4d(1, i, j, k);
  };
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (!(values[n] > 0)) continue;
    const Eigen::Vector4d place = placeOf(voxels[n]);
    products += place * place.transpose();
    sums += std::log(values[n]) * place;
  }
  const Eigen::Vector4d trend = products.ldlt().solve(sums);
  if (!trend.allFinite()) return;
  for (std::size_t n = 0; n < values.size(); ++n) {
    values[n] *= static_cast<float>(std::exp(-trend.dot(placeOf(voxels[n]))));
  }
}

}  // namespace

HeadContrast measureContrast(const Volume<float>& image) {
  HeadContrast found;
  found.thickest = image.grid.spacing.maxCoeff();
  const Volume<float> blocks = inBlocks(image, kCube);
  const Volume<float> squared = squaredDistanceTo(airOf(blocks));
  const float deepest = *std::max_element(squared.data.begin(), squared.data.end());
  std::vector<float> deep;
  std::vector<std::size_t> voxels;
  for (std::size_t v = 0; v < blocks.size(); ++v) {
    if (!(squared[v] > kInner * kInner * deepest)) continue;
    deep.push_back(blocks[v]);
    voxels.push_back(v);
  }
  if (deep.size() < kFewest) return found;
  divideByTrend(blocks.grid, voxels, deep);
  std::sort(deep.begin(), deep.end());
  const auto at = [&](double share) {
    return static_cast<double>(deep[static_cast<std::size_t>(share * (deep.size() - 1.0))]);
  };
  const double median = at(0.5), range = at(0.95) - at(0.05);
  if (!(median > 0) || !(range > 0)) return found;
  found.skewness = (at(0.95) + at(0.05) - 2 * median) / range;
  found.spread = range / median;
  found.brightest = at(0.999) / median;
  const auto bright = std::count_if(deep.begin(), deep.end(),
                                    [&](float value) { return value > kBright * median; });
  found.brightShare = static_cast<double>(bright) / static_cast<double>(deep.size());
  return found;
}

float countFromAir(Volume<float>& image) {
  constexpr double kDarkest = 0.01;  // air is more than that, a resampling's undershoots are less
  if (std::all_of(image.data.begin(), image.data.end(), [](float value) { return value >= 0; }) ||
      judge("hounsfield", airInHounsfieldUnits(image), {})) {
    return 0;
  }
  // Around a stripped brain air is 0.  Below it lie an interpolation's undershoots, which are
  // shallow, or half of a brain that was scaled to mean 0 within its mask.
  constexpr float kUndershoot = 0.1f;  // of an edge, in the middle: Gibbs' is 0.09 at most
  const float bright = std::max(0.0f, quantileOf(image.data, 0.99)), little = 1e-3f * bright;
  std::vector<float> dark;
  std::ranges::copy_if(image.data, std::back_inserter(dark), [&](float v) { return v < -little; });
  const auto none =
      std::ranges::count_if(image.data, [&](float v) { return std::abs(v) <= little; });
  if (none > static_cast<std::ptrdiff_t>(dark.size())) {
    const bool isScaled = !dark.empty() && quantileOf(dark, 0.5) < -kUndershoot * bright;
    const float lift = isScaled ? -*std::ranges::min_element(dark) : 0;
    const float air = isScaled ? 0 : little;
    for (float& value : image.data)
      value = std::abs(value) <= air ? 0 : std::max(0.0f, value + lift);
    return lift;
  }
  const float lift = -std::min(0.0f, quantileOf(image.data, kDarkest));
  for (float& value : image.data) value = std::max(0.0f, value + lift);
  return lift;
}

}  // namespace explica::segmentation
