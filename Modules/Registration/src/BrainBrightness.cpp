// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "BrainBrightness.h"

#include "Filters.h"

#include <algorithm>
#include <functional>
#include <vector>

namespace explica::registration {
namespace {

constexpr double kNeighbourhood = 20;     // mm: fields of coils are smoother
constexpr double kBrainDepth = 4;         // mm below the expected border: brain in nearly any head
constexpr double kSkullFrom = 2;          // mm above the expected border: the skull begins ...
constexpr double kSkullTo = 12;           // ... and ends
constexpr double kMostFluid = 0.45;       // of white matter: grey matter of any T1 is brighter
constexpr double kGuess = 0.25;           // of white matter: fluid where none lies deep enough
constexpr double kLeastDeviation = 0.03;  // of white matter: narrower is no noise of a scanner
constexpr float kFaint = 1e-4f;           // of the global mean, where nothing is near
constexpr std::size_t kFewest = 30;       // voxels whose median is believed

using Chosen = std::function<bool(std::size_t)>;

/// Mean of the chosen voxels within some 20 mm, known everywhere.
Volume<float> localMean(const Volume<float>& image, const Chosen& chosen) {
  Volume<float> weight(image.grid, 0.0f), sum(image.grid, 0.0f);
  double count = 0, total = 0;
  for (std::size_t v = 0; v < image.size(); ++v) {
    if (!chosen(v)) continue;
    weight[v] = 1;
    sum[v] = image[v];
    count += 1;
    total += image[v];
  }
  const auto mean = static_cast<float>(count > 0 ? total / count : 1);
  // Averages over tens of millimetres need no fine grid.
  const auto& n = image.grid.size;
  const Grid coarse = cubicGrid(image.grid, Vector::Zero(), Vector(n[0] - 1, n[1] - 1, n[2] - 1),
                                0.3 * kNeighbourhood);
  weight = smoothed(resampled(weight, coarse), kNeighbourhood);
  sum = smoothed(resampled(sum, coarse), kNeighbourhood);
  for (std::size_t v = 0; v < sum.size(); ++v) {
    sum[v] = (sum[v] + kFaint * mean) / (weight[v] + kFaint);
  }
  return volumeBy(image.grid, [&](const Vector& index) {
    Vector at = coarse.toIndex(image.grid.toWorld(index));
    for (int a = 0; a < 3; ++a) at[a] = std::clamp(at[a], 0.0, coarse.size[a] - 1.0);
    return valueAt(sum, at);
  });
}

/// Brightness of chosen voxels that are darker than a level, and so are their six neighbours: no
/// voxel that is partly something brighter.
std::vector<float> darkOf(const Volume<float>& relative, double below, const Chosen& chosen) {
  const auto& n = relative.grid.size;
  std::vector<float> values;
  for (int k = 1; k + 1 < n[2]; ++k) {
    for (int j = 1; j + 1 < n[1]; ++j) {
      for (int i = 1; i + 1 < n[0]; ++i) {
        if (!chosen(relative.grid.linear(i, j, k))) continue;
        const float brightest = std::max(
            {relative(i, j, k), relative(i - 1, j, k), relative(i + 1, j, k), relative(i, j - 1, k),
             relative(i, j + 1, k), relative(i, j, k - 1), relative(i, j, k + 1)});
        if (brightest < below) values.push_back(relative(i, j, k));
      }
    }
  }
  return values;
}

/// Median, and half of the range of the middle 68 %.
BrightnessLevel levelOf(std::vector<float> values, double guess) {
  if (values.size() < kFewest) return {guess, kLeastDeviation};
  std::ranges::sort(values);
  const auto at = [&](double share) {
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
  };
  return {at(0.5), std::max<double>(0.5 * (at(0.84) - at(0.16)), kLeastDeviation)};
}

}  // namespace

BrainBrightness measureBrightness(const Volume<float>& image, const Volume<float>& distance) {
  const auto deep = [&](std::size_t v) { return distance[v] < -kBrainDepth; };
  const Volume<float> mean = localMean(image, deep);
  // What is brighter than the mean of grey and white matter is mostly white matter.
  const Volume<float> white =
      localMean(image, [&](std::size_t v) { return deep(v) && image[v] > mean[v]; });
  BrainBrightness found;
  found.relative = image;
  for (std::size_t v = 0; v < image.size(); ++v) found.relative[v] /= std::max(white[v], 1e-30f);
  found.fluid = levelOf(darkOf(found.relative, kMostFluid, deep), kGuess);
  const auto skull = [&](std::size_t v) {
    return distance[v] > kSkullFrom && distance[v] < kSkullTo;
  };
  found.bone = levelOf(darkOf(found.relative, found.fluid.mean, skull), 0.5 * found.fluid.mean);
  return found;
}

}  // namespace explica::registration
