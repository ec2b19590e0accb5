// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "BorderLevels.h"

#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::segmentation {
namespace {

constexpr std::size_t kBorderGrain = 16384;  // elements a task
/// The level of all edges weighs as much as so many voxels with a tenth of the range a mm.
constexpr double kPrior = 25, kPriorSlope = 0.1;
/// A level stays this share of the means' distance away from them.
constexpr double kMargin = 0.1;
/// Of a sum of three squared normal numbers; single edges among pure voxels do not move the median.
constexpr float kMedianOverMean = 0.79F;

/// The least or largest of each voxel and its neighbours, corners included.
template <class Choose>
std::vector<float> among(const EdgeSamples& samples, const Choose& choose) {
  std::vector<float> values = *samples.intensity, next(values.size());
  for (int axis = 0; axis < 3; ++axis) {
    parallelFor(values.size(), kBorderGrain, [&](std::size_t v) {
      next[v] = values[v];
      for (int n = 2 * axis; n < 2 * axis + 2; ++n) {
        const std::int32_t other = (*samples.neighbours)[v][n];
        if (other >= 0) next[v] = choose(next[v], values[other]);
      }
    });
    values.swap(next);
  }
  return values;
}

/// Median of a value over voxels of one tissue, where only noise makes it; 0 if there are none.
template <class Value>
float medianOfPure(const std::vector<std::uint8_t>& pure, const Value& valueAt) {
  std::vector<float> noise;
  for (std::size_t v = 0; v < pure.size(); ++v) {
    if (pure[v] != 0) noise.push_back(valueAt(v));
  }
  return noise.empty() ? 0 : upperMedian(std::move(noise));
}

/// Length of the gradient, without noise.
std::vector<float> slopesOf(const EdgeSamples& samples) {
  const std::vector<float>& values = *samples.intensity;
  std::vector<float> slopes(values.size());
  parallelFor(values.size(), kBorderGrain, [&](std::size_t v) {
    double squared = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t before = (*samples.neighbours)[v][2 * axis];
      const std::int32_t after = (*samples.neighbours)[v][2 * axis + 1];
      if (before < 0 || after < 0) continue;
      const double rise = (values[after] - values[before]) / (2 * samples.spacing[axis]);
      squared += rise * rise;
    }
    slopes[v] = static_cast<float>(squared);
  });
  const float noise =
      medianOfPure(samples.pure, [&](std::size_t v) { return slopes[v]; }) / kMedianOverMean;
  for (float& slope : slopes) slope = std::sqrt(std::max(0.0F, slope - noise));
  return slopes;
}

}  // namespace

BorderFinder::BorderFinder(const BlockWindow& window, const EdgeSamples& samples,
                           const std::array<double, 3>& mean)
    : window_(window), samples_(samples), mean_(mean), slope_(slopesOf(samples)) {
  least_ = among(samples, [](float a, float b) { return std::min(a, b); });
  most_ = among(samples, [](float a, float b) { return std::max(a, b); });
  // The extremes of many voxels lie off their tissue by noise, and a level that took them for
  // another tissue would climb through it: by so much as white matter's brightest does.
  noise_ =
      medianOfPure(samples.pure, [&](std::size_t v) { return most_[v] - (*samples.intensity)[v]; });
  const auto middle = [&](int k) { return static_cast<float>(0.5 * (mean[k] + mean[k + 1])); };
  levels_.outer.assign(slope_.size(), middle(0));
  levels_.white.assign(slope_.size(), middle(1));
}

void BorderFinder::updateLevel(std::vector<float>& level, const std::vector<float>& weight) const {
  std::vector<float> weighted(weight.size());
  double all = 0, sum = 0;
  for (std::size_t v = 0; v < weight.size(); ++v) {
    weighted[v] = weight[v] * (*samples_.intensity)[v];
    all += weight[v];
    sum += weighted[v];
  }
  if (!(all > 0)) return;
  const double prior = kPrior * kPriorSlope * (mean_[2] - mean_[0]);
  std::vector<double> sums = window_.sums(*samples_.voxel, weighted);
  const std::vector<double> weights = window_.sums(*samples_.voxel, weight);
  for (std::size_t b = 0; b < sums.size(); ++b) {
    sums[b] = (sums[b] + prior * sum / all) / (weights[b] + prior);
  }
  level = window_.atVoxels(sums, *samples_.voxel);
}

void BorderFinder::improve() {
  std::vector<float> outer(slope_.size()), white(slope_.size());
  // A level that asked its own darker side for fluid would climb through grey matter's noise where
  // a tight mask has left hardly any.
  const auto fluidAtMost = static_cast<float>(0.5 * (mean_[0] + mean_[1]));
  parallelFor(slope_.size(), kBorderGrain, [&](std::size_t v) {
    const float low = levels_.outer[v], high = levels_.white[v];
    const bool counts = (*samples_.rim)[v] == 0;
    const bool fluid = least_[v]<low, grey = most_[v]> low && least_[v] < high;
    const bool bright = most_[v] > high;
    const bool besideWhite = most_[v] - noise_ > high && least_[v] + noise_ < high;
    outer[v] = counts && least_[v] < fluidAtMost && grey && !bright ? slope_[v] : 0;
    white[v] = !fluid && besideWhite ? slope_[v] : 0;
  });
  updateLevel(levels_.outer, outer);
  updateLevel(levels_.white, white);
  const auto between = [&](float level, int k) {
    const double margin = kMargin * (mean_[k + 1] - mean_[k]);
    return std::clamp(level, static_cast<float>(mean_[k] + margin),
                      static_cast<float>(mean_[k + 1] - margin));
  };
  parallelFor(slope_.size(), kBorderGrain, [&](std::size_t v) {
    levels_.outer[v] = between(levels_.outer[v], 0);
    levels_.white[v] = between(levels_.white[v], 1);
  });
}

std::vector<float> evened(const std::vector<float>& intensity, const BorderLevels& levels,
                          const std::array<double, 3>& mean) {
  const std::array<double, 4> even = {mean[0], 0.5 * (mean[0] + mean[1]), 0.5 * (mean[1] + mean[2]),
                                      mean[2]};
  std::vector<float> result(intensity.size());
  parallelFor(intensity.size(), kBorderGrain, [&](std::size_t v) {
    const std::array<double, 4> here = {mean[0], levels.outer[v], levels.white[v], mean[2]};
    const double y = intensity[v];
    const int k = y < here[1] ? 0 : (y < here[2] ? 1 : 2);
    const double share = (y - here[k]) / (here[k + 1] - here[k]);
    result[v] = static_cast<float>(even[k] + share * (even[k + 1] - even[k]));
  });
  return result;
}

}  // namespace explica::segmentation
