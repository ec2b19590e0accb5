// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Segmentation/Hemisphere.h"

#include "HemisphereDraft.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace explica::segmentation {
namespace {

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

Volume<std::uint8_t> maskOf(const Volume<Label>& labels, Label label) {
  return setWhere(labels.grid, [&](std::size_t v) { return labels[v] == label; });
}

Volume<Label> resampleLabels(const Volume<Label>& labels, const Grid& grid) {
  Volume<Label> resampled(grid, 0);
  for (std::size_t v = 0; v < resampled.size(); ++v) {
    const std::int64_t from = voxelAt(labels.grid, centreOf(grid, v));
    if (from >= 0) resampled[v] = labels[from];
  }
  return resampled;
}

}  // namespace explica::segmentation
