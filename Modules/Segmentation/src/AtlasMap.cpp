// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "AtlasMap.h"

#include "Explica/Core/OrderStatistics.h"

#include <array>
#include <cmath>
#include <initializer_list>
#include <vector>

namespace explica::segmentation {
namespace {

constexpr double kFluidOverCortex = 0.7;  // of the brightness of cortical labels: darker is fluid
constexpr double kDeepShare = 0.12;  // of the brain's radius, 8 mm in an adult: sulci open nearer
constexpr double kOffCortex = 2;     // mm from cortical labels

bool beginsWithAny(const std::string& name, std::initializer_list<std::string_view> beginnings) {
  return std::any_of(beginnings.begin(), beginnings.end(), [&](std::string_view beginning) {
    return name.compare(0, beginning.size(), beginning) == 0;
  });
}

bool isMesialDeep(const std::string& name) {
  return beginsWithAny(name, {"Hippocampus", "Amygdala"});
}

bool bordersStem(const std::string& name) {
  return isMesialDeep(name) || beginsWithAny(name, {"ParaHippocampal", "Lingual", "Fusiform"});
}

/// Axis of the grid that runs nearest to a world axis, and whether it runs the same way.
struct NearestAxis {
  int axis;
  bool sameWay;
};
NearestAxis axisAlong(const Grid& grid, int world) {
  NearestAxis nearest{0, true};
  double best = -1;
  for (int a = 0; a < 3; ++a) {
    const double c = grid.direction(world, a);
    if (std::abs(c) > best) {
      best = std::abs(c);
      nearest = {a, c > 0};
    }
  }
  return nearest;
}

}  // namespace

AtlasMap mapAtlas(const Volume<Label>& atlas, const AtlasLegend& legend) {
  AtlasMap map{Volume<std::uint8_t>(atlas.grid), Volume<std::uint8_t>(atlas.grid),
               Volume<std::uint8_t>(atlas.grid), VoxelSet(atlas.grid, 0)};
  for (std::size_t v = 0; v < atlas.size(); ++v) {
    if (atlas[v] == 0) continue;
    const auto entry = legend.find(atlas[v]);
    if (entry == legend.end()) {
      throw InvalidInput("atlas: label " + std::to_string(atlas[v]) +
                         " is not in the legend; give the legend that belongs to this atlas");
    }
    map.kind[v] = kindCode(entry->second.kind);
    map.side[v] = sideCode(entry->second.side);
    map.medialTemporal[v] = bordersStem(entry->second.name) ? 1 : 0;
    map.mesialDeep[v] = isMesialDeep(entry->second.name) ? 1 : 0;
  }
  return map;
}

VoxelSet findStem(const AtlasMap& map, const AtlasLegend& legend, const Volume<Label>& atlas) {
  const Grid& grid = atlas.grid;
  const bool labelled = std::any_of(legend.begin(), legend.end(), [](const auto& entry) {
    return entry.second.kind == StructureKind::Stem;
  });
  if (labelled) {
    return setWhere(grid,
                    [&](std::size_t v) { return map.kind[v] == kindCode(StructureKind::Stem); });
  }
  std::vector<double> heights;
  for (std::size_t v = 0; v < atlas.size(); ++v) {
    if (map.kind[v] != kindCode(StructureKind::Deep)) continue;
    if (legend.at(atlas[v]).name.compare(0, 8, "Thalamus") != 0) continue;
    heights.push_back(centreOf(grid, v).z());
  }
  VoxelSet stem(grid, 0);
  if (heights.empty()) return stem;
  const double top = nthSmallest(heights, heights.size() / 20);

  const NearestAxis right = axisAlong(grid, 0);
  const NearestAxis front = axisAlong(grid, 1);
  const int planes = grid.size[front.axis];
  // Positions along the left-right axis, counted towards the right.
  std::vector<int> leftBorder(planes, -1);
  std::vector<int> rightBorder(planes, grid.size[right.axis]);
  const auto towardsRight = [&](const std::array<int, 3>& at) {
    return right.sameWay ? at[right.axis] : grid.size[right.axis] - 1 - at[right.axis];
  };
  const auto below = [&](const std::array<int, 3>& at) {
    return grid.toWorld(Vector(at[0], at[1], at[2])).z() < top;
  };
  for (std::size_t v = 0; v < atlas.size(); ++v) {
    if (map.medialTemporal[v] == 0) continue;
    const auto at = grid.subscripts(v);
    if (!below(at)) continue;
    const int plane = at[front.axis];
    const int x = towardsRight(at);
    if (map.side[v] == sideCode(Side::Left)) leftBorder[plane] = std::max(leftBorder[plane], x);
    if (map.side[v] == sideCode(Side::Right)) rightBorder[plane] = std::min(rightBorder[plane], x);
  }
  const auto near = [&](bool beside) {
    return squaredDistanceTo(setWhere(grid, [&](std::size_t v) {
      if (map.kind[v] == kindCode(StructureKind::Cortex))
        return (map.medialTemporal[v] != 0) == beside;
      return beside && map.kind[v] != 0;
    }));
  };
  const Volume<float> toNeighbours = near(true), toOthers = near(false);
  for (std::size_t v = 0; v < atlas.size(); ++v) {
    if (map.kind[v] != 0 || toOthers[v] < toNeighbours[v]) continue;
    const auto at = grid.subscripts(v);
    const int plane = at[front.axis];
    if (leftBorder[plane] < 0 || rightBorder[plane] == grid.size[right.axis]) continue;
    const int x = towardsRight(at);
    if (x > leftBorder[plane] && x < rightBorder[plane] && below(at)) stem[v] = 1;
  }
  return stem;
}

Label labelStem(Volume<Label>& atlas, AtlasLegend& legend) {
  const VoxelSet stem = findStem(mapAtlas(atlas, legend), legend, atlas);
  const Label label = legend.empty() ? 1 : legend.rbegin()->first + 1;
  bool any = false;
  for (std::size_t v = 0; v < stem.size(); ++v) {
    if (stem[v] == 0) continue;
    atlas[v] = label;
    any = true;
  }
  if (!any) return 0;
  legend[label] = {"Brain_Stem", Side::Both, StructureKind::Stem};
  return label;
}

void labelVentricles(const Volume<float>& brain, Volume<Label>& atlas, AtlasLegend& legend) {
  const Grid& grid = atlas.grid;
  const AtlasMap map = mapAtlas(atlas, legend);
  const auto isOf = [&](StructureKind kind) {
    return [&map, kind](std::size_t v) { return map.kind[v] == kindCode(kind); };
  };
  const VoxelSet cortex = setWhere(grid, isOf(StructureKind::Cortex));
  std::vector<float> values;
  for (std::size_t v = 0; v < brain.size(); ++v) {
    if (cortex[v] != 0 && brain[v] > 0) values.push_back(brain[v]);
  }
  if (values.empty()) return;
  const double dark = kFluidOverCortex * upperMedian(std::move(values));
  const VoxelSet outside = setWhere(grid, [&](std::size_t v) { return !(brain[v] > 0); });
  const auto inside = static_cast<double>(brain.size() - voxelsIn(outside));
  const double depth = kDeepShare * std::cbrt(0.75 / kPi * inside * grid.voxelVolume());
  const Volume<float> toOutside = squaredDistanceTo(outside), toCortex = squaredDistanceTo(cortex);
  const Components voids = componentsOf(setWhere(grid, [&](std::size_t v) {
    return map.kind[v] == 0 && brain[v] < dark && toOutside[v] > depth * depth &&
           toCortex[v] >= kOffCortex * kOffCortex;
  }));
  const VoxelSet deep = setWhere(grid, isOf(StructureKind::Deep));
  std::vector<std::uint8_t> nearDeep(voids.size.size(), 0);
  for (std::size_t v = 0; v < deep.size(); ++v) {
    if (voids.number[v] >= 0 && touches(grid, v, deep)) nearDeep[voids.number[v]] = 1;
  }
  std::array<Volume<float>, 2> to;
  std::array<Label, 2> names;
  for (const Side side : {Side::Left, Side::Right}) {
    const bool right = side == Side::Right;
    to[right] = squaredDistanceTo(
        setWhere(grid, [&](std::size_t v) { return deep[v] && map.side[v] == sideCode(side); }));
    names[right] = legend.empty() ? 1 : legend.rbegin()->first + 1;
    legend[names[right]] = structureNamed(std::string(kVentricleName) + (right ? "_R" : "_L"));
  }
  for (std::size_t v = 0; v < atlas.size(); ++v) {
    const std::int32_t n = voids.number[v];
    if (n >= 0 && nearDeep[n] != 0) atlas[v] = names[to[1][v] < to[0][v]];
  }
}

}  // namespace explica::segmentation
