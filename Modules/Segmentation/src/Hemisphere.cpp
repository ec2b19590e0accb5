// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/Hemisphere.h"

#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/VoxelSets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace explica::segmentation {
namespace {

// White matter joined to the rest by less than two voxels, and has no cortex about it.
constexpr double kThread = 1.1;        // voxels: what is left of it is further from its border
constexpr double kReach = 1.1;         // voxels beyond that which belong to it again
constexpr double kLeastPiece = 10;     // mm^3: fewer voxels tell nothing
constexpr double kAround = 1;          // mm: cortex is twice as thick
constexpr double kCortexAround = 0.6;  // measured: white matter from 0.74, fat up to 0.48

// Grey matter beside hippocampus and amygdala.
constexpr double kDeepestCortex = 4;  // mm to its outside: deeper is hardly any [von Economo 1925]
constexpr double kRimReach = 8;       // mm: farther the atlas does not err

// Muscle, dura and sinuses at the base of the skull are as bright as cortex.
constexpr double kFarthestCortex = 6;  // mm from white matter: of label maps 0.2 % lie beyond

// Ventricles of a template.
constexpr double kFluidOverCortex = 0.7;  // of the brightness of cortical labels: darker is fluid
constexpr double kDeepShare = 0.12;  // of the brain's radius, 8 mm in an adult: sulci open nearer
constexpr double kOffCortex = 2;     // mm from cortical labels

/// What the atlas says of each voxel.
struct AtlasMap {
  Volume<std::uint8_t> kind;  ///< 0 unlabelled, else 1 + StructureKind
  Volume<std::uint8_t> side;  ///< 1 left, 2 right, 0 otherwise
  Volume<std::uint8_t>
      medialTemporal;   ///< nonzero in structures that border the brain stem's cisterns
  VoxelSet mesialDeep;  ///< hippocampus and amygdala, which no white matter parts from cortex
};

constexpr std::uint8_t kindCode(StructureKind kind) {
  return static_cast<std::uint8_t>(1 + static_cast<int>(kind));
}
constexpr std::uint8_t sideCode(Side side) {
  return static_cast<std::uint8_t>(side);
}

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

/// As labelVentricles names them.
constexpr std::string_view kVentricleName = "Deep_ventricle";

bool isVentricle(const std::string& name) {
  return name.compare(0, kVentricleName.size(), kVentricleName) == 0;
}

std::int64_t voxelsIn(const VoxelSet& set) {
  return std::count_if(set.data.begin(), set.data.end(), [](std::uint8_t v) { return v != 0; });
}

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

template <class Test>
VoxelSet setWhere(const Grid& grid, const Test& test) {
  VoxelSet set(grid, 0);
  parallelFor(set.size(), 65536, [&](std::size_t v) { set[v] = test(v) ? 1 : 0; });
  return set;
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

/// The brain stem: see extractHemisphere.
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
    const auto [i, j, k] = grid.subscripts(v);
    heights.push_back(grid.toWorld(Vector(i, j, k)).z());
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

/// Visits the voxels that share a face with one.
template <class Visit>
void forNeighbours(const Grid& grid, std::size_t v, const Visit& visit) {
  for (const std::int64_t w : grid.neighbours(v)) {
    if (w >= 0) visit(static_cast<std::size_t>(w));
  }
}

bool touches(const Grid& grid, std::size_t v, const VoxelSet& set) {
  bool found = false;
  forNeighbours(grid, v, [&](std::size_t w) { found = found || set[w] != 0; });
  return found;
}

/// A hemisphere while it is put together.
struct Draft {
  VoxelSet own;     ///< tissue and fluid on its side
  VoxelSet white;   ///< white matter, and what counts as such
  VoxelSet filled;  ///< of these, what is not white by the segmentation
  VoxelSet tissue;  ///< white and grey matter
};

/// What both hemispheres are extracted by: the atlas, and where its structures are nearest, squared
/// distances in mm^2.
struct Anatomy {
  const Volume<Label>& atlas;
  const AtlasLegend& legend;
  AtlasMap map;
  VoxelSet stem;
  Volume<float> toLeft, toRight, toBelowTent, toCortex;

  Anatomy(const Volume<Label>& labels, const AtlasLegend& names)
      : atlas(labels),
        legend(names),
        map(mapAtlas(atlas, legend)),
        stem(findStem(map, legend, atlas)),
        toLeft(toCerebral(Side::Left)),
        toRight(toCerebral(Side::Right)),
        toBelowTent(toKind(StructureKind::BelowTent)),
        toCortex(toKind(StructureKind::Cortex)) {}

  /// Ties between the halves go to the left, so that the two hemispheres never share a voxel.
  [[nodiscard]] bool isOn(Side side, std::size_t v) const {
    const bool half = side == Side::Left ? toLeft[v] <= toRight[v] : toRight[v] < toLeft[v];
    return half && (side == Side::Left ? toLeft : toRight)[v] <= toBelowTent[v] && stem[v] == 0;
  }

 private:
  [[nodiscard]] Volume<float> toKind(StructureKind kind) const {
    return squaredDistanceTo(
        setWhere(atlas.grid, [&](std::size_t v) { return map.kind[v] == kindCode(kind); }));
  }
  [[nodiscard]] Volume<float> toCerebral(Side side) const {
    return squaredDistanceTo(setWhere(atlas.grid, [&](std::size_t v) {
      return map.kind[v] != 0 && map.kind[v] != kindCode(StructureKind::BelowTent) &&
             map.kind[v] != kindCode(StructureKind::Stem) && map.side[v] == sideCode(side);
    }));
  }
};

/// White matter and the deep structures, which count as such; how many voxels these add.
std::int64_t takeDeep(const VoxelSet& deep, const Volume<Label>& seg, Draft& draft) {
  std::int64_t added = 0;
  for (std::size_t v = 0; v < deep.size(); ++v) {
    if (draft.own[v] != 0 && seg[v] == kWhite) draft.white[v] = 1;
    if (deep[v] == 0) continue;
    if (draft.white[v] == 0) ++added;
    draft.white[v] = draft.filled[v] = 1;
  }
  return added;
}

/// Fills voids that border deep structures and do not open to the outside, and those that the atlas
/// says are ventricles, with all that is nearer to them, by steps through voids, than to what is
/// none: choroid fissure and foramina join ventricles and cisterns.  How many voxels.
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
  std::int64_t count = 0;
  for (std::size_t v = 0; v < seg.size(); ++v) {
    const std::int32_t n = voids.number[v];
    if (n < 0 || !(reached[v] == kVentricle || (nearDeep[n] != 0 && open[n] == 0))) continue;
    draft.white[v] = draft.filled[v] = 1;
    ++count;
  }
  return count;
}

/// Fills fluid that borders what is filled, and that tissue closes off from the outside: what an
/// atlas leaves of the ventricles, as temporal horns in the midst of cortical labels.  The voxels.
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
  for (std::size_t v = 0; v < seg.size(); ++v) {
    if (closed[v] != 0) draft.white[v] = draft.filled[v] = 1;
  }
  return closed;
}

/// Fills grey matter that is nearer to deep structures than to the outside, by ways through grey
/// matter, and deeper than cortex is: what an atlas leaves of hippocampus and amygdala would be
/// cortex without an outside, and the surface would open a sulcus between them and the gyrus below.
/// How many voxels.
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
  std::int64_t count = 0;
  for (std::size_t v = 0; v < seg.size(); ++v) {
    const bool isCortex = fromOutside[v] <= std::max<float>(fromDeep[v], kDeepestCortex);
    if (grey[v] == 0 || isCortex || !std::isfinite(fromDeep[v])) continue;
    draft.white[v] = draft.filled[v] = 1;
    ++count;
  }
  return count;
}

/// Only the largest piece of a set counts; how many voxels that leaves out.
std::int64_t keepLargest(VoxelSet& set, const Components& pieces) {
  const std::int32_t largest = pieces.largest();
  std::int64_t dropped = 0;
  for (std::size_t v = 0; v < set.size(); ++v) {
    if (set[v] == 0 || pieces.number[v] == largest) continue;
    set[v] = 0;
    ++dropped;
  }
  return dropped;
}

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

/// Takes off what is joined to white matter by a thread and has no cortex about it, as fat of the
/// orbit that stripping has left; how many voxels.
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

/// Fills what white matter encloses; how many voxels.
std::int64_t fillCavities(Draft& draft) {
  VoxelSet& white = draft.white;
  const Components around =
      componentsOf(setWhere(white.grid, [&](std::size_t v) { return white[v] == 0; }));
  const std::int32_t outside = around.largest();
  std::int64_t count = 0;
  for (std::size_t v = 0; v < white.size(); ++v) {
    if (white[v] != 0 || around.number[v] == outside) continue;
    white[v] = draft.filled[v] = 1;
    ++count;
  }
  return count;
}

/// Takes off tissue that is farther from white matter than cortex is thick; how many voxels.
std::int64_t dropFarFromWhite(Draft& draft) {
  const Volume<float> toWhite = squaredDistanceTo(draft.white);
  std::int64_t count = 0;
  for (std::size_t v = 0; v < toWhite.size(); ++v) {
    if (draft.tissue[v] == 0 || toWhite[v] <= kFarthestCortex * kFarthestCortex) continue;
    draft.tissue[v] = 0;
    ++count;
  }
  return count;
}

/// Labels and shares of tissue from the finished draft; `cut` are voxels where the hemisphere was
/// cut off from the rest.
void label(const TissueSegmentation& tissue, const Draft& draft, const VoxelSet& cut,
           Hemisphere& result) {
  const Grid& grid = tissue.labels.grid;
  result.labels = Volume<Label>(grid, 0);
  result.whiteShare = Volume<float>(grid, 0.0f);
  result.tissueShare = Volume<float>(grid, 0.0f);
  for (std::size_t v = 0; v < cut.size(); ++v) {
    const float both = tissue.probability[1][v] + tissue.probability[2][v];
    if (draft.white[v] != 0) {
      result.labels[v] = kWhite;
      ++result.whiteVoxels;
      result.whiteShare[v] = draft.filled[v] != 0 ? 1.0f : tissue.probability[2][v];
      result.tissueShare[v] = draft.filled[v] != 0 ? 1.0f : both;
    } else if (draft.tissue[v] != 0) {
      result.labels[v] = kGrey;
      ++result.greyVoxels;
      // A voxel that is mostly white but stray stays below one half.
      result.whiteShare[v] = std::min(tissue.probability[2][v], 0.49f);
      result.tissueShare[v] = both;
    } else if (draft.own[v] != 0) {
      result.labels[v] = kCsf;
      result.tissueShare[v] = std::min(both, 0.49f);
    } else if (cut[v] != 0) {
      result.labels[v] = kCut;
    }
  }
}

void requireSameGrid(const TissueSegmentation& tissue, const Volume<Label>& atlas) {
  if (!sameGrid(tissue.labels.grid, atlas.grid)) {
    throw InvalidInput(
        "atlas: lies on another grid than the segmentation; resample its labels to the T1's grid");
  }
}

Hemisphere extract(const TissueSegmentation& tissue, const Anatomy& anatomy, Side side,
                   const HemisphereOptions& options, const Monitor& monitor) {
  const Grid& grid = tissue.labels.grid;
  const Volume<Label>& seg = tissue.labels;
  const AtlasMap& map = anatomy.map;
  const auto ours = [&](std::size_t v) { return anatomy.isOn(side, v); };
  Draft draft{setWhere(grid, [&](std::size_t v) { return seg[v] != 0 && ours(v); }),
              VoxelSet(grid, 0), VoxelSet(grid, 0), VoxelSet(grid, 0)};

  monitor.progress(0.5, "filling deep structures and ventricles");
  Hemisphere result;
  const VoxelSet deep = setWhere(grid, [&](std::size_t v) {
    return draft.own[v] != 0 && map.kind[v] == kindCode(StructureKind::Deep);
  });
  result.deepVoxels = takeDeep(deep, seg, draft);
  const double leastSquared = options.coreDepth * options.coreDepth;
  const VoxelSet voids = setWhere(grid, [&](std::size_t v) {
    return ours(v) && map.kind[v] == 0 && seg[v] != kWhite && anatomy.toCortex[v] >= leastSquared;
  });
  const VoxelSet ventricle = setWhere(grid, [&](std::size_t v) {
    return deep[v] != 0 && isVentricle(anatomy.legend.at(anatomy.atlas[v]).name);
  });
  result.ventricleVoxels = fillVentricles(voids, deep, ventricle, seg, draft) + voxelsIn(ventricle);
  VoxelSet mesial = fillClosedFluid(seg, draft);
  result.ventricleVoxels += voxelsIn(mesial);
  for (std::size_t v = 0; v < mesial.size(); ++v) {
    mesial[v] = mesial[v] != 0 || (draft.own[v] != 0 && map.mesialDeep[v] != 0) ? 1 : 0;
  }
  result.deepVoxels += takeMesialRim(std::move(mesial), seg, draft);
  if (result.ventricleVoxels == 0) {
    monitor.warn(
        "no ventricle was found next to the deep structures: where fluid borders white matter "
        "inside the hemisphere, the white surface will follow it");
  }

  monitor.progress(0.7, "cleaning the hemisphere");
  const Components pieces = componentsOf(draft.white);
  if (pieces.largest() < 0) {
    throw InvalidInput(
        "segmentation: no white matter voxel in the hemisphere; check that atlas and T1 overlap");
  }
  result.strayVoxels = keepLargest(draft.white, pieces);
  if (const std::int64_t hanging = dropHanging(draft.white, seg); hanging > 0) {
    result.strayVoxels += hanging + keepLargest(draft.white, componentsOf(draft.white));
  }
  result.cavityVoxels = fillCavities(draft);
  draft.tissue = setWhere(grid, [&](std::size_t v) {
    return draft.white[v] != 0 || (draft.own[v] != 0 && (seg[v] == kGrey || seg[v] == kWhite));
  });
  result.strayVoxels += dropFarFromWhite(draft);
  result.strayVoxels += keepLargest(draft.tissue, componentsOf(draft.tissue));

  label(tissue, draft,
        setWhere(grid,
                 [&](std::size_t v) {
                   return seg[v] == kWhite || map.kind[v] == kindCode(StructureKind::Deep) ||
                          (anatomy.stem[v] != 0 && seg[v] == kGrey);
                 }),
        result);
  if (result.greyVoxels == 0) {
    throw InvalidInput(
        "segmentation: no grey matter voxel in the hemisphere; check that atlas and T1 overlap");
  }
  monitor.progress(1, "hemisphere");
  return result;
}

}  // namespace

Hemisphere extractHemisphere(const TissueSegmentation& tissue, const Volume<Label>& atlas,
                             const AtlasLegend& legend, const HemisphereOptions& options,
                             const Monitor& monitor) {
  requireSameGrid(tissue, atlas);
  if (options.side == Side::Both) throw InvalidInput("hemisphere: found 'both', expected L or R");
  monitor.progress(0.1, "nearest atlas labels");
  return extract(tissue, Anatomy(atlas, legend), options.side, options, monitor);
}

std::array<Hemisphere, 2> extractHemispheres(const TissueSegmentation& tissue,
                                             const Volume<Label>& atlas, const AtlasLegend& legend,
                                             const HemisphereOptions& options,
                                             const Monitor& monitor) {
  requireSameGrid(tissue, atlas);
  monitor.progress(0.1, "nearest atlas labels");
  const Anatomy anatomy(atlas, legend);
  std::array<Hemisphere, 2> both;
  parallelTasks(2, [&](std::size_t right) {
    both[right] = extract(tissue, anatomy, right != 0 ? Side::Right : Side::Left, options, monitor);
  });
  return both;
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

Volume<std::uint8_t> maskOf(const Volume<Label>& labels, Label label) {
  return setWhere(labels.grid, [&](std::size_t v) { return labels[v] == label; });
}

Volume<Label> resampleLabels(const Volume<Label>& labels, const Grid& grid) {
  Volume<Label> resampled(grid, 0);
  for (std::size_t v = 0; v < resampled.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const Vector at = labels.grid.toIndex(grid.toWorld(Vector(i, j, k)));
    const int si = static_cast<int>(std::lround(at.x()));
    const int sj = static_cast<int>(std::lround(at.y()));
    const int sk = static_cast<int>(std::lround(at.z()));
    if (labels.grid.contains(si, sj, sk)) resampled[v] = labels(si, sj, sk);
  }
  return resampled;
}

}  // namespace explica::segmentation
