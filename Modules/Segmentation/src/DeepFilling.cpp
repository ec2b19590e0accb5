// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "HemisphereDraft.h"

#include <cmath>
#include <vector>

namespace explica::segmentation {
namespace {

// Grey matter beside hippocampus and amygdala.
constexpr double kDeepestCortex = 4;  // mm to its outside: deeper is hardly any [von Economo 1925]
constexpr double kRimReach = 8;       // mm: farther the atlas does not err

}  // namespace

std::int64_t takeDeep(const VoxelSet& deep, const Volume<Label>& seg, Draft& draft) {
  for (std::size_t v = 0; v < deep.size(); ++v) {
    if (draft.own[v] != 0 && seg[v] == kWhite) draft.white[v] = 1;
    if (deep[v] != 0 && draft.white[v] != 0) draft.filled[v] = 1;
  }
  return draft.fillWhere([&](std::size_t v) { return deep[v] != 0 && draft.white[v] == 0; });
}

std::int64_t fillVentricles(const VoxelSet& voidSet, const VoxelSet& deep,
                            const VoxelSet& ventricle, const Volume<Label>& seg, Draft& draft) {
  const Grid& grid = seg.grid;
  const Components voids = componentsOf(voidSet);
  const VoxelSet outside = setWhere(grid, [&](std::size_t v) { return seg[v] == 0; });
  const VoxelSet cortex = setWhere(grid, [&](std::size_t v) {
    return draft.own[v] != 0 && seg[v] != kWhite && voidSet[v] == 0 && deep[v] == 0;
  });
  std::vector<std::uint8_t> nearDeep(voids.size.size(), 0);
  std::vector<std::uint8_t> open(voids.size.size(), 0);
  enum : std::uint8_t { kUnreached, kVentricle, kOther };
  VoxelSet reached(grid, kUnreached);
  std::vector<std::size_t> front;
  for (std::size_t v = 0; v < seg.size(); ++v) {
    const std::int32_t n = voids.number[v];
    if (n < 0) continue;
    if (touches(grid, v, deep)) nearDeep[n] = 1;
    const bool atOutside = outside[v] != 0 || touches(grid, v, outside);
    if (atOutside) open[n] = 1;
    if (atOutside || touches(grid, v, cortex)) {
      reached[v] = kOther;
    } else if (touches(grid, v, ventricle)) {
      reached[v] = kVentricle;
    }
    if (reached[v] != kUnreached) front.push_back(v);
  }
  for (std::size_t next = 0; next < front.size(); ++next) {
    forNeighbours(grid, front[next], [&](std::size_t w) {
      if (voidSet[w] == 0 || reached[w] != kUnreached) return;
      reached[w] = reached[front[next]];
      front.push_back(w);
    });
  }
  return draft.fillWhere([&](std::size_t v) {
    const std::int32_t n = voids.number[v];
    return n >= 0 && (reached[v] == kVentricle || (nearDeep[n] != 0 && open[n] == 0));
  });
}

VoxelSet fillClosedFluid(const Volume<Label>& seg, Draft& draft) {
  const Grid& grid = seg.grid;
  const Components fluid = componentsOf(setWhere(
      grid, [&](std::size_t v) { return seg[v] == 0 || (seg[v] == kCsf && draft.white[v] == 0); }));
  std::vector<std::uint8_t> beside(fluid.size.size(), 0), open(fluid.size.size(), 0);
  for (std::size_t v = 0; v < seg.size(); ++v) {
    const std::int32_t n = fluid.number[v];
    if (n < 0) continue;
    if (seg[v] == 0) open[n] = 1;
    if (touches(grid, v, draft.filled)) beside[n] = 1;
  }
  VoxelSet closed = setWhere(grid, [&](std::size_t v) {
    const std::int32_t n = fluid.number[v];
    return draft.own[v] != 0 && n >= 0 && beside[n] != 0 && open[n] == 0;
  });
  draft.fillWhere([&](std::size_t v) { return closed[v] != 0; });
  return closed;
}

std::int64_t takeMesialRim(VoxelSet deep, const Volume<Label>& seg, Draft& draft) {
  const Grid& grid = seg.grid;
  const Volume<float> toDeep = squaredDistanceTo(deep);
  const auto near = [&](std::size_t v) { return toDeep[v] <= kRimReach * kRimReach; };
  const VoxelSet grey = setWhere(grid, [&](std::size_t v) {
    return near(v) && draft.own[v] != 0 && draft.white[v] == 0 && seg[v] == kGrey;
  });
  VoxelSet outside = setWhere(grid, [&](std::size_t v) {
    return near(v) && draft.white[v] == 0 && (seg[v] == kCsf || seg[v] == 0);
  });
  const Volume<float> fromDeep = spreadLabels(grey, deep),
                      fromOutside = spreadLabels(grey, outside);
  return draft.fillWhere([&](std::size_t v) {
    const bool isCortex = fromOutside[v] <= std::max<float>(fromDeep[v], kDeepestCortex);
    return grey[v] != 0 && !isCortex && std::isfinite(fromDeep[v]);
  });
}

}  // namespace explica::segmentation
