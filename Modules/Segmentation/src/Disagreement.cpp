// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/Disagreement.h"

#include "Explica/Core/Errors.h"
#include "Explica/Segmentation/Tissue.h"
#include "VoxelSets.h"

#include <array>

namespace explica::segmentation {
namespace {

/// Pieces below are registration's: bert on Colin27 has none above 0.34 ml.
constexpr double kLeastPiece = 500;  // mm^3

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

}  // namespace

Disagreement whiteDisagreement(const Volume<Label>& tissues, const Volume<float>& expected,
                               double depth) {
  const Grid& grid = tissues.grid;
  if (!sameGrid(grid, expected.grid)) {
    throw InvalidInput("template: lies on another grid than the tissues");
  }
  const double level = whiteLevel(tissues, expected);
  VoxelSet other(grid, 0);
  for (std::size_t v = 0; v < other.size(); ++v) other[v] = expected[v] > level ? 0 : 1;
  const Volume<float> squared = squaredDistanceTo(other);
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
  const Components pieces = componentsOf(differs);
  if (pieces.largest() >= 0) {
    found.largest = static_cast<double>(pieces.size[pieces.largest()]) * grid.voxelVolume();
  }
  for (const std::int64_t size : pieces.size) {
    if (static_cast<double>(size) * grid.voxelVolume() >= kLeastPiece) found.voxels += size;
  }
  return found;
}

}  // namespace explica::segmentation
