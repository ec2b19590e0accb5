// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Registration/SkullStripping.h"

#include "Explica/Core/Errors.h"
#include "Filters.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace explica::registration {
namespace {

constexpr double kCoreDepth = 4;       // mm below the mask's border: brain beyond doubt
constexpr double kNeighbourhood = 20;  // mm: bias fields are smoother

using Set = Volume<std::uint8_t>;

/// Voxels whose nearest voxel outside of the set is further than about so many mm.
Set eroded(const Set& set, double by) {
  Volume<float> soft(set.grid);
  std::transform(set.data.begin(), set.data.end(), soft.data.begin(),
                 [](std::uint8_t in) { return static_cast<float>(in); });
  const int radius = std::max(1, static_cast<int>(std::lround(by / set.grid.spacing.mean())));
  soft = boxMean(std::move(soft), radius);
  Set result(set.grid, 0);
  for (std::size_t v = 0; v < set.size(); ++v) result[v] = soft[v] > 0.999f ? 1 : 0;
  return result;
}

/// Voxels within about so many mm of the set.
Set dilated(const Set& set, double by) {
  Set outside(set.grid);
  std::transform(set.data.begin(), set.data.end(), outside.data.begin(),
                 [](std::uint8_t in) -> std::uint8_t { return in != 0 ? 0 : 1; });
  Set result = eroded(outside, by);
  for (auto& in : result.data) in = in != 0 ? 0 : 1;
  return result;
}

/// The voxels of the set that faces connect with a seed.
Set reached(const Set& set, const Set& seeds) {
  Set result(set.grid, 0);
  std::vector<std::size_t> stack;
  for (std::size_t v = 0; v < set.size(); ++v) {
    if (set[v] == 0 || seeds[v] == 0) continue;
    result[v] = 1;
    stack.push_back(v);
  }
  while (!stack.empty()) {
    const auto at = set.grid.subscripts(stack.back());
    stack.pop_back();
    for (int n = 0; n < 6; ++n) {
      auto next = at;
      next[n / 2] += n % 2 == 0 ? -1 : 1;
      if (!set.grid.contains(next[0], next[1], next[2])) continue;
      const std::size_t w = set.grid.linear(next[0], next[1], next[2]);
      if (set[w] == 0 || result[w] != 0) continue;
      result[w] = 1;
      stack.push_back(w);
    }
  }
  return result;
}

/// Brightness relative to the brain nearby.
Volume<float> relativeBrightness(const Volume<float>& image, const Set& core) {
  Volume<float> sum(image.grid), weight(image.grid);
  for (std::size_t v = 0; v < image.size(); ++v) {
    weight[v] = core[v];
    sum[v] = core[v] != 0 ? image[v] : 0;
  }
  // Averages over tens of millimetres need no fine grid.
  const auto& n = image.grid.size;
  const Grid coarse = cubicGrid(image.grid, Vector::Zero(), Vector(n[0] - 1, n[1] - 1, n[2] - 1),
                                0.3 * kNeighbourhood);
  sum = smoothed(resampled(sum, coarse), kNeighbourhood);
  weight = smoothed(resampled(weight, coarse), kNeighbourhood);
  Volume<float> relative(image.grid, 0.0f);
  forPlanes(image.grid, [&](int k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) {
        Vector at = coarse.toIndex(image.grid.toWorld(Vector(i, j, k)));
        for (int a = 0; a < 3; ++a) at[a] = std::clamp(at[a], 0.0, coarse.size[a] - 1.0);
        const float mean = valueAt(sum, at);
        if (mean > 0) relative(i, j, k) = image(i, j, k) * valueAt(weight, at) / mean;
      }
    }
  });
  return relative;
}

}  // namespace

Volume<Label> stripSkull(const Volume<float>& image, const Volume<float>& brain,
                         const StrippingOptions& options) {
  Set mask(image.grid, 0);
  for (std::size_t v = 0; v < mask.size(); ++v) mask[v] = brain[v] > 0.5f ? 1 : 0;
  if (std::find(mask.data.begin(), mask.data.end(), 1) == mask.data.end()) {
    throw InvalidInput("T1: the template's brain lies outside of the image");
  }
  const Set core = eroded(mask, kCoreDepth);
  const Volume<float> relative = relativeBrightness(image, core);
  const Set wide = dilated(mask, options.reach);
  Set tissue(image.grid, 0);
  for (std::size_t v = 0; v < mask.size(); ++v) {
    const bool bright = relative[v] >= options.dimmest && relative[v] <= options.brightest;
    tissue[v] = core[v] != 0 || (wide[v] != 0 && bright) ? 1 : 0;
  }
  // Opened, so that dura and vessels do not lead out; then as far back as tissue goes.
  const Set solid = reached(eroded(tissue, 0.5 * options.opening), core);
  const Set grown = dilated(solid, 0.5 * options.opening);
  Set beyond(image.grid, 0);
  for (std::size_t v = 0; v < mask.size(); ++v) {
    beyond[v] = mask[v] == 0 && grown[v] != 0 && tissue[v] != 0 ? 1 : 0;
  }
  // With the voxels about them that are partly tissue.
  const Set rim = dilated(beyond, image.grid.spacing.mean());
  Volume<Label> result(image.grid, 0);
  for (std::size_t v = 0; v < mask.size(); ++v) {
    const bool outside = beyond[v] != 0 || (rim[v] != 0 && relative[v] < options.dimmest);
    const bool inside = core[v] != 0 || relative[v] <= options.brightest;
    result[v] = mask[v] != 0 ? (inside ? 1 : 0) : (outside ? 1 : 0);
  }
  return result;
}

}  // namespace explica::registration
