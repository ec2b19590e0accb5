// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "HemisphereDraft.h"

#include <array>
#include <cmath>
#include <vector>

namespace explica::segmentation {
namespace {

// White matter joined to the rest by less than two voxels, and has no cortex about it.
constexpr double kThread = 1.1;        // voxels: what is left of it is further from its border
constexpr double kReach = 1.1;         // voxels beyond that which belong to it again
constexpr double kLeastPiece = 10;     // mm^3: fewer voxels tell nothing
constexpr double kAround = 1;          // mm: cortex is twice as thick
constexpr double kCortexAround = 0.6;  // measured: white matter from 0.74, fat up to 0.48

// Muscle, dura and sinuses at the base of the skull are as bright as cortex.
constexpr double kFarthestCortex = 6;  // mm from white matter: of label maps 0.2 % lie beyond

/// Voxels near a piece, with their squared distances to it, mm^2.
struct Nearby {
  std::vector<std::size_t> voxel;
  std::vector<float> squared;
};

/// What is within `reach` mm of a piece, found in the box around it.
Nearby around(const Grid& grid, const std::vector<std::size_t>& piece, double reach) {
  std::array<int, 3> low = grid.size, high = {0, 0, 0};
  for (const std::size_t v : piece) {
    const auto at = grid.subscripts(v);
    for (int d = 0; d < 3; ++d) {
      const int more = static_cast<int>(std::ceil(reach / grid.spacing[d]));
      low[d] = std::min(low[d], std::max(at[d] - more, 0));
      high[d] = std::max(high[d], std::min(at[d] + more + 1, grid.size[d]));
    }
  }
  Grid box = grid;
  for (int d = 0; d < 3; ++d) box.size[d] = high[d] - low[d];
  VoxelSet set(box, 0);
  for (const std::size_t v : piece) {
    const auto [i, j, k] = grid.subscripts(v);
    set(i - low[0], j - low[1], k - low[2]) = 1;
  }
  const Volume<float> squared = squaredDistanceTo(set);
  Nearby near;
  for (std::size_t b = 0; b < squared.size(); ++b) {
    if (squared[b] > reach * reach) continue;
    const auto [i, j, k] = box.subscripts(b);
    near.voxel.push_back(grid.linear(i + low[0], j + low[1], k + low[2]));
    near.squared.push_back(squared[b]);
  }
  return near;
}

/// Takes off a piece of white matter unless there is cortex about it; how many voxels.
std::int64_t dropUnlessInCortex(VoxelSet& white, const Volume<Label>& seg,
                                const std::vector<std::size_t>& piece,
                                const Volume<float>& toMain) {
  const double own = (kThread + kReach) * std::cbrt(white.grid.voxelVolume());
  const Nearby near = around(white.grid, piece, own + kAround);
  const auto belongs = [&](std::size_t n) { return !(near.squared[n] > own * own); };
  std::int64_t about = 0, cortex = 0;
  for (std::size_t n = 0; n < near.voxel.size(); ++n) {
    if (white[near.voxel[n]] != 0 || belongs(n)) continue;
    ++about;
    cortex += seg[near.voxel[n]] == kGrey ? 1 : 0;
  }
  if (about == 0 || static_cast<double>(cortex) >= kCortexAround * static_cast<double>(about)) {
    return 0;
  }
  std::int64_t dropped = 0;
  for (std::size_t n = 0; n < near.voxel.size(); ++n) {
    const std::size_t v = near.voxel[n];
    if (white[v] == 0 || !belongs(n) || toMain[v] < near.squared[n]) continue;
    white[v] = 0;
    ++dropped;
  }
  return dropped;
}

}  // namespace

std::int64_t keepLargest(VoxelSet& set, const Components& pieces) {
  const std::int32_t largest = pieces.largest();
  return dropWhere(set, [&](std::size_t v) { return pieces.number[v] != largest; });
}

std::int64_t dropHanging(VoxelSet& white, const Volume<Label>& seg) {
  const Grid& grid = white.grid;
  const double thread = kThread * std::cbrt(grid.voxelVolume());
  const Volume<float> inside =
      squaredDistanceTo(setWhere(grid, [&](std::size_t v) { return white[v] == 0; }));
  const Components cores =
      componentsOf(setWhere(grid, [&](std::size_t v) { return inside[v] > thread * thread; }));
  const auto main = cores.largest();
  if (main < 0) return 0;
  const auto least = static_cast<std::int64_t>(std::ceil(kLeastPiece / grid.voxelVolume()));
  std::vector<std::vector<std::size_t>> pieces(cores.size.size());
  bool any = false;
  for (std::size_t v = 0; v < white.size(); ++v) {
    const std::int32_t n = cores.number[v];
    if (n < 0 || n == main || cores.size[n] < least) continue;
    pieces[n].push_back(v);
    any = true;
  }
  if (!any) return 0;
  const Volume<float> toMain =
      squaredDistanceTo(setWhere(grid, [&](std::size_t v) { return cores.number[v] == main; }));
  std::int64_t dropped = 0;
  for (const auto& piece : pieces) {
    if (!piece.empty()) dropped += dropUnlessInCortex(white, seg, piece, toMain);
  }
  return dropped;
}

std::int64_t fillCavities(Draft& draft) {
  VoxelSet& white = draft.white;
  const Components around =
      componentsOf(setWhere(white.grid, [&](std::size_t v) { return white[v] == 0; }));
  const std::int32_t outside = around.largest();
  return draft.fillWhere(
      [&](std::size_t v) { return white[v] == 0 && around.number[v] != outside; });
}

std::int64_t dropFarFromWhite(Draft& draft) {
  const Volume<float> toWhite = squaredDistanceTo(draft.white);
  return dropWhere(draft.tissue,
                   [&](std::size_t v) { return toWhite[v] > kFarthestCortex * kFarthestCortex; });
}

}  // namespace explica::segmentation
