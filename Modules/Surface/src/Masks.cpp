// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Masks.h"

#include "Explica/Core/OutermostLayer.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>

namespace explica::surface {

Mask maskOf(const Volume<Label>& volume, const std::vector<Label>& labels) {
  Mask mask(volume.grid);
  if (labels.empty()) return mask;
  const Label low = *std::min_element(labels.begin(), labels.end());
  const Label high = *std::max_element(labels.begin(), labels.end());
  std::vector<std::uint8_t> wanted(static_cast<std::size_t>(high - low) + 1, 0);
  for (const Label label : labels) wanted[label - low] = 1;
  parallelFor(volume.size(), 1 << 18, [&](std::size_t v) {
    const Label value = volume[v];
    if (value >= low && value <= high) mask[v] = wanted[value - low];
  });
  return mask;
}

std::int64_t countOnEdge(const Mask& mask) {
  std::int64_t count = 0;
  forOutermost(mask.grid, [&](int i, int j, int k) { count += mask(i, j, k) != 0; });
  return count;
}

std::int64_t addNearer(const Mask& unsided, Mask& own, const Mask& other) {
  if (voxelsIn(unsided) == 0) return 0;
  Mask sides(own.grid);
  for (std::size_t v = 0; v < own.size(); ++v) sides[v] = own[v] ? 1 : (other[v] ? 2 : 0);
  // Only the voxels without side are walked through; waves start at the sides' rims.
  spreadLabels(unsided, sides);
  std::int64_t added = 0;
  for (std::size_t v = 0; v < own.size(); ++v) {
    if (unsided[v] && sides[v] == 1 && !own[v]) {
      own[v] = 1;
      ++added;
    }
  }
  return added;
}

}  // namespace explica::surface
