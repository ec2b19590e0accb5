// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/Disagreement.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/VoxelSets.h"
#include "Explica/Segmentation/Tissue.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace explica::segmentation {
namespace {

/// Thinner pieces are the anatomy's: into those of healthy heads on Colin27, brought affinely, no
/// ball of more than 3.5 mm fits (README.md).
constexpr double kLeastRadius = 5;  // mm

/// Half way between the template's brightness under grey and under white voxels.
double whiteLevel(const Volume<Label>& tissues, const Volume<float>& expected) {
  std::array<double, 4> sum{}, count{};
  for (std::size_t v = 0; v < tissues.size(); ++v) {
    if (tissues[v] < kCsf || tissues[v] > kWhite || !(expected[v] > 0)) continue;
    sum[tissues[v]] += expected[v];
    ++count[tissues[v]];
  }
  if (count[kGrey] == 0 || count[kWhite] == 0) return kNaN;
  return 0.5 * (sum[kGrey] / count[kGrey] + sum[kWhite] / count[kWhite]);
}

/// Sizes of the pieces, and which of them are as thick as a lesion.
void measurePieces(const VoxelSet& differs, Disagreement& found) {
  const Grid& grid = differs.grid;
  const Components pieces = componentsOf(differs);
  if (pieces.largest() < 0) return;
  found.largest = static_cast<double>(pieces.size[pieces.largest()]) * grid.voxelVolume();
  const Volume<float> squared =
      squaredDistanceTo(setWhere(grid, [&](std::size_t v) { return differs[v] == 0; }));
  std::vector<float> inside(pieces.size.size(), 0);
  for (std::size_t v = 0; v < differs.size(); ++v) {
    if (differs[v] == 0) continue;
    float& most = inside[pieces.number[v]];
    most = std::max(most, squared[v]);
    if (!(std::sqrt(squared[v]) > found.deepest)) continue;
    found.deepest = std::sqrt(squared[v]);
    found.middle = centreOf(grid, v);
  }
  for (std::size_t n = 0; n < inside.size(); ++n) {
    if (inside[n] >= kLeastRadius * kLeastRadius) found.voxels += pieces.size[n];
  }
}

}  // namespace

Disagreement whiteDisagreement(const Volume<Label>& tissues, const Volume<float>& expected,
                               double depth) {
  const Grid& grid = tissues.grid;
  if (!sameGrid(grid, expected.grid)) {
    throw InvalidInput("template: lies on another grid than the tissues");
  }
  const double level = whiteLevel(tissues, expected);
  const Volume<float> squared =
      squaredDistanceTo(setWhere(grid, [&](std::size_t v) { return !(expected[v] > level); }));
  VoxelSet differs(grid, 0);
  double deep = 0, different = 0;
  for (std::size_t v = 0; v < differs.size(); ++v) {
    if (tissues[v] == 0 || !(squared[v] > depth * depth)) continue;
    ++deep;
    if (tissues[v] == kWhite) continue;
    differs[v] = 1;
    ++different;
  }
  Disagreement found;
  if (deep == 0) return found;
  found.share = different / deep;
  measurePieces(differs, found);
  return found;
}

}  // namespace explica::segmentation
