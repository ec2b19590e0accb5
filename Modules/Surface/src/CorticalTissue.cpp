// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/CorticalTissue.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/OutermostLayer.h"
#include "Explica/Core/Parallel.h"
#include "Hemispheres.h"
#include "LabelPresets.h"
#include "Masks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace explica::surface {
namespace {

/// @throws InvalidInput  none of the labels is there; of some that are not the reader is told
void requirePresent(const Histogram& histogram, const Labels& labels, const std::string& name,
                    const Monitor& monitor) {
  std::size_t missing = 0;
  std::string absent = name + ": label ";
  for (const Label label : labels) {
    if (histogram.contains(label)) continue;
    absent += (missing++ == 0 ? "" : ", ") + std::to_string(label);
  }
  if (missing == 0) return;
  absent += " absent";
  if (missing == labels.size()) throw InvalidInput(absent + " (found " + listOf(histogram) + ")");
  monitor.warn(absent + "; the other labels of its list are used");
}

constexpr std::size_t kVoxelGrain = 1 << 18;  // voxels a task

void addTo(Mask& mask, const Mask& other) {
  parallelFor(mask.size(), kVoxelGrain, [&](std::size_t v) {
    mask[v] = static_cast<std::uint8_t>(mask[v] != 0 || other[v] != 0);
  });
}

void requireInside(const Mask& mask, bool closeEdges, const Monitor& monitor) {
  const std::int64_t atEdge = countOnEdge(mask);
  if (atEdge == 0) return;
  const std::string found =
      "white matter touches the edge of the field of view at " + std::to_string(atEdge) + " voxels";
  if (!closeEdges) {
    throw InvalidInput(found +
                       "; a closed surface needs background around it: give a larger field of "
                       "view, --sheet always for sheets with a rim, or --close-edges");
  }
  monitor.warn(found + "; the surface is closed there");
}

void sortUnique(Labels& labels) {
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
}

/// The box, and everything of it, that later steps need.
CorticalTissue assemble(const Mask& white, const Mask& tissue, const Mask& insulated) {
  // Room for the boundary's normals and for one layer of background.
  constexpr int kMargin = 5;
  const VoxelBox box = boundingBox(tissue, kMargin);
  CorticalTissue result;
  result.white = levelSetOf(crop(white, box));
  result.tissue = levelSetOf(crop(tissue, box));
  result.insulated = crop(insulated, box);
  return result;
}

/// Which labels are what, once the preset and the options are known.
struct Roles {
  Labels white, grey, fill, insulated;
  Labels unsided;            ///< joined to white matter where it is nearer than `otherWhite`
  Labels otherWhite;         ///< the other hemisphere's
  bool split = false;        ///< both hemispheres share the labels
  bool sided = false;        ///< the labels are those of one hemisphere
  bool borderLines = false;  ///< borders are lines of voxels
  Side side = Side::Left;    ///< if the labels are sided
};

Side otherThan(Side side) {
  return side == Side::Left ? Side::Right : Side::Left;
}

void refuseBothHemispheres(std::int64_t left, std::int64_t right, const char* what) {
  throw InvalidInput("labels: both hemispheres are present (" + std::string(what) +
                     std::to_string(left) + " voxels left, " + std::to_string(right) +
                     " right); choose --hemisphere L or R");
}

/// Of labels that tell the hemispheres apart.
void takeSide(const PresetLabels& preset, const Histogram& histogram, const TissueOptions& options,
              Roles& roles) {
  const std::int64_t left = countOf(histogram, preset.left.white);
  const std::int64_t right = countOf(histogram, preset.right.white);
  if (!options.hemisphere && left > 0 && right > 0 && options.white.empty()) {
    refuseBothHemispheres(left, right, "white matter ");
  }
  roles.sided = true;
  roles.side = options.hemisphere.value_or(left > 0 ? Side::Left : Side::Right);
  const PresetLabels::Hemisphere& other = preset.of(otherThan(roles.side));
  roles.otherWhite = other.white;
  roles.otherWhite.insert(roles.otherWhite.end(), other.fill.begin(), other.fill.end());
  roles.insulated = roles.otherWhite;
}

/// White matter of FreeSurfer's wm, which has no label for it.
Labels whiteOfWm(const Histogram& histogram) {
  constexpr Label kLeastWhite = 5;  // FreeSurfer's threshold of wm.mgz
  Labels white;
  for (const auto& [label, count] : histogram) {
    if (label >= kLeastWhite) white.push_back(label);
  }
  return white;
}

bool isFilled(const Histogram& histogram) {
  return histogram.contains(255) && histogram.contains(127) && histogram.size() <= 4;
}

/// What a preset says.
Roles rolesOf(LabelPreset preset, const Histogram& histogram, const TissueOptions& options) {
  Roles roles;
  if (preset == LabelPreset::None) {
    roles.split = options.hemisphere.has_value();
    return roles;
  }
  if (preset == LabelPreset::Wm && !isFilled(histogram)) {
    roles.white = whiteOfWm(histogram);
    roles.split = options.hemisphere.has_value();
    return roles;
  }
  const PresetLabels labels = labelsOf(preset, histogram);
  if (preset == LabelPreset::Wm) {
    if (!options.hemisphere && options.white.empty()) {
      refuseBothHemispheres(histogram.at(255), histogram.at(127), "");
    }
    roles.white = labels.of(options.hemisphere.value_or(Side::Left)).white;
    return roles;
  }
  if (labels.sided) takeSide(labels, histogram, options, roles);
  roles.split = !labels.sided && options.hemisphere.has_value();
  const PresetLabels::Hemisphere& own = labels.of(roles.side);
  roles.white = own.white;
  roles.grey = own.grey;
  roles.fill = own.fill;
  roles.unsided = labels.unsided;
  roles.insulated.insert(roles.insulated.end(), labels.insulated.begin(), labels.insulated.end());
  roles.borderLines = labels.borderLines;
  return roles;
}

/// What the options name goes before what the preset says.
void takeNamed(const TissueOptions& options, Roles& roles) {
  if (!options.white.empty()) roles.white = options.white;
  if (!options.grey.empty()) roles.grey = options.grey;
  if (!options.fill.empty()) {
    roles.fill = options.fill;
    roles.unsided.clear();
  } else if (options.noFill) {
    roles.fill.clear();
    roles.unsided.clear();
  }
  if (!options.insulated.empty()) roles.insulated = options.insulated;
  if (roles.white.empty()) throw InvalidInput("white: no label named");
  for (Labels* labels : {&roles.white, &roles.grey, &roles.fill}) sortUnique(*labels);
}

void checkRoles(const Histogram& histogram, const TissueOptions& options, const Roles& roles,
                const Monitor& monitor) {
  // A preset names more labels than most images have.
  const Monitor ofWhite = options.white.empty() ? Monitor{} : monitor;
  requirePresent(histogram, roles.white, "white", ofWhite);
  requirePresent(histogram, roles.grey, "grey", monitor);
  if (!options.fill.empty()) requirePresent(histogram, roles.fill, "fill", monitor);
  if (!options.insulated.empty()) {
    requirePresent(histogram, roles.insulated, "insulated", monitor);
  }
  for (const Label label : roles.grey) {
    if (std::binary_search(roles.white.begin(), roles.white.end(), label) ||
        std::binary_search(roles.fill.begin(), roles.fill.end(), label)) {
      throw InvalidInput("grey: label " + std::to_string(label) + " is also white or filled");
    }
  }
}

/// Visits a voxel and those that share a corner with it.
template <class Visit>
void visitAround(const Grid& grid, std::size_t v, const Visit& visit) {
  const auto at = grid.subscripts(v);
  for (int n = 0; n < 27; ++n) {
    const int i = at[0] + n % 3 - 1, j = at[1] + n / 3 % 3 - 1, k = at[2] + n / 9 - 1;
    if (grid.contains(i, j, k)) visit(grid.linear(i, j, k));
  }
}

/// Beyond a border line voxels have no label of their own: near it they are what the line is.
/// Where fluid's line is near, too, the nearer of both counts.
void growBorderLines(const Mask& fluid, TissueMasks& masks) {
  constexpr int kRounds = 2;  // voxels
  const Grid& grid = fluid.grid;
  enum : std::uint8_t { kUnknown, kWhite, kFluid };
  Mask side(grid);
  std::vector<std::size_t> front;
  for (std::size_t v = 0; v < side.size(); ++v) {
    side[v] = masks.white[v] ? kWhite : (fluid[v] ? kFluid : kUnknown);
    if (side[v] != kUnknown) front.push_back(v);
  }
  for (int round = 0; round < kRounds; ++round) {
    std::map<std::size_t, int> votes;  // of voxels beside the front, white less fluid
    for (const std::size_t v : front) {
      visitAround(grid, v, [&](std::size_t w) {
        if (side[w] == kUnknown && masks.insulated[w]) votes[w] += side[v] == kWhite ? 1 : -1;
      });
    }
    front.clear();
    for (const auto& [v, lead] : votes) {
      if (lead == 0) continue;
      side[v] = lead > 0 ? kWhite : kFluid;
      front.push_back(v);
    }
  }
  for (std::size_t v = 0; v < side.size(); ++v) {
    if (side[v] == kUnknown) continue;
    masks.white[v] = side[v] == kWhite;
    masks.insulated[v] = 0;
  }
}

std::string structureOf(const Roles& roles, const TissueOptions& options) {
  if (!options.hemisphere && !roles.sided) return "Cortex";
  const Side side = options.hemisphere.value_or(roles.side);
  return side == Side::Left ? "CortexLeft" : "CortexRight";
}

}  // namespace

Volume<float> sharesOf(Volume<float> scalars, std::optional<double> level,
                       const std::string& name) {
  const auto [low, high] = std::minmax_element(scalars.data.begin(), scalars.data.end());
  if (scalars.size() == 0) throw InvalidInput(name + ": empty volume");
  const bool isShare = *low >= 0;
  const double boundary = level.value_or(isShare ? 0.5 * *high : 0.0);
  if (!(*low < boundary && boundary < *high)) {
    throw InvalidInput(name + ": level " + std::to_string(boundary) +
                       " is nowhere crossed (values from " + std::to_string(*low) + " to " +
                       std::to_string(*high) + ")");
  }
  // Distances count up to two voxels from the boundary; farther off nobody asks.
  const double scale = isShare && !level
                           ? *high
                           : (isShare ? 2 * std::max(boundary - *low, *high - boundary)
                                      : 4 * scalars.grid.spacing.maxCoeff());
  std::int64_t above = 0, below = 0;
  forOutermost(scalars.grid,
               [&](int i, int j, int k) { ++(scalars(i, j, k) > boundary ? above : below); });
  const double sign = above <= below ? 1 : -1;
  parallelFor(scalars.size(), 1 << 18, [&](std::size_t v) {
    scalars[v] =
        static_cast<float>(std::clamp(0.5 + sign * (scalars[v] - boundary) / scale, 0.0, 1.0));
  });
  return scalars;
}

Volume<float> addShares(const Volume<float>& a, const Volume<float>& b) {
  if (!sameGrid(a.grid, b.grid)) {
    throw InvalidInput("shares: white and grey matter are on different grids");
  }
  Volume<float> sum(a.grid);
  parallelFor(sum.size(), 1 << 18, [&](std::size_t v) { sum[v] = std::min(1.0F, a[v] + b[v]); });
  return sum;
}

bool runsOutOfImage(const TissueMasks& masks) {
  constexpr double kShare = 0.01;  // of grey voxels; a closely cropped brain has less on the edge
  return static_cast<double>(countOnEdge(masks.grey)) >
         kShare * static_cast<double>(voxelsIn(masks.grey));
}

bool isBlock(const TissueMasks& masks) {
  return masks.greyVoxels > 0 && (masks.preset == LabelPreset::LayNii || runsOutOfImage(masks));
}

TissueMasks masksFromLabels(const Volume<Label>& labels, const TissueOptions& options,
                            const Monitor& monitor) {
  if (labels.grid.dimension() != 3) {
    throw InvalidInput(
        "labels: one slice; a surface needs a volume (explica thickness gives a slice's inner, "
        "middle and outer contours)");
  }
  const Histogram histogram = histogramOf(labels);
  TissueMasks masks;
  masks.preset = options.preset;
  if (masks.preset == LabelPreset::Auto) {
    masks.preset = options.white.empty() ? guessPreset(labels, histogram) : LabelPreset::None;
  }
  Roles roles = rolesOf(masks.preset, histogram, options);
  if (options.white.empty()) masks.unknownLabels = unknownTo(masks.preset, histogram);
  takeNamed(options, roles);
  checkRoles(histogram, options, roles, monitor);
  masks.structure = structureOf(roles, options);

  monitor.progress(0.1, "labels");
  masks.white = maskOf(labels, roles.white);
  masks.grey = maskOf(labels, roles.grey);
  masks.insulated = maskOf(labels, roles.insulated);
  masks.whiteVoxels = voxelsIn(masks.white);
  const Mask filled = maskOf(labels, roles.fill);
  masks.filledVoxels =
      countWhere(filled.size(), [&](std::size_t v) { return filled[v] && !masks.white[v]; });
  if (masks.filledVoxels > 0) addTo(masks.white, filled);
  if (!roles.unsided.empty()) {
    masks.filledVoxels +=
        addNearer(maskOf(labels, roles.unsided), masks.white, maskOf(labels, roles.otherWhite));
  }
  if (roles.borderLines) growBorderLines(maskOf(labels, {1}), masks);
  if (roles.split) {
    monitor.progress(0.3, "separating hemispheres");
    masks.cutContact = takeHemisphere(*options.hemisphere, masks, monitor);
  } else if (!roles.sided && !options.hemisphere) {
    warnOfTwoHemispheres(masks.white, monitor);
  }
  if (voxelsIn(masks.white) == 0) {
    throw InvalidInput("white: no voxel left after separation (labelled white: " +
                       std::to_string(masks.whiteVoxels) + " voxels)");
  }
  masks.greyVoxels = voxelsIn(masks.grey);
  masks.atImageBorder = countOnEdge(masks.white) + countOnEdge(masks.grey);
  parallelFor(masks.white.size(), kVoxelGrain, [&](std::size_t v) {
    if (masks.white[v] || masks.grey[v]) masks.insulated[v] = 0;
  });
  return masks;
}

CorticalTissue tissueFromMasks(const TissueMasks& masks, bool closeEdges, const Monitor& monitor) {
  requireInside(masks.white, closeEdges, monitor);
  Mask tissue = masks.white;
  addTo(tissue, masks.grey);
  monitor.progress(0.7, "level sets");
  CorticalTissue result = assemble(masks.white, tissue, masks.insulated);
  static_cast<TissueFacts&>(result) = masks;
  result.hasGrey = masks.greyVoxels > 0;
  result.ofLabels = true;
  monitor.progress(1.0, "level sets");
  return result;
}

double bareShare(const CorticalTissue& tissue) {
  const Grid& grid = tissue.white.grid;
  double bare = 0, all = 0;  // mm^2 of voxel faces
  for (std::size_t v = 0; v < tissue.white.size(); ++v) {
    if (!(tissue.white[v] > 0)) continue;
    const auto neighbours = grid.neighbours(v);
    for (int d = 0; d < 6; ++d) {
      const std::int64_t w = neighbours[d];
      if (w < 0 || tissue.white[w] > 0 || tissue.insulated[w] != 0) continue;
      const double area = grid.voxelVolume() / grid.spacing[d / 2];
      all += area;
      if (!(tissue.tissue[w] > 0)) bare += area;
    }
  }
  return all > 0 ? bare / all : 0;
}

CorticalTissue withCortexAllAround(CorticalTissue tissue) {
  const Grid& grid = tissue.white.grid;
  Mask near(grid);  // what is beside bare white matter
  for (std::size_t v = 0; v < near.size(); ++v) {
    if (!(tissue.white[v] > 0)) continue;
    const auto neighbours = grid.neighbours(v);
    const bool isBare = std::any_of(neighbours.begin(), neighbours.end(), [&](std::int64_t w) {
      return w >= 0 && !(tissue.tissue[w] > 0);
    });
    if (isBare) visitAround(grid, v, [&](std::size_t w) { near[w] = 1; });
  }
  const Components places = componentsOf(near);
  const std::int32_t medialWall = places.largest();
  const LevelSet outer = distanceLevelOf(tissue.tissue);
  const auto voxel = static_cast<float>(grid.spacing.maxCoeff() / bandOf(grid));
  for (std::size_t v = 0; v < near.size(); ++v) {
    if (!near[v] || places.number[v] == medialWall) continue;
    tissue.white[v] = offZero(std::min(tissue.white[v], outer[v] - voxel));
  }
  return tissue;
}

CorticalTissue tissueFromLabels(const Volume<Label>& labels, const TissueOptions& options,
                                const Monitor& monitor) {
  return tissueFromMasks(masksFromLabels(labels, options, monitor), options.closeEdges, monitor);
}

CorticalTissue tissueFromShares(const Volume<float>& white, const Volume<float>& tissue,
                                const Volume<std::uint8_t>& insulated, const TissueOptions& options,
                                const Monitor& monitor) {
  const bool hasTissue = tissue.size() > 0;
  if (hasTissue && !sameGrid(white.grid, tissue.grid)) {
    throw InvalidInput("tissue: not on the grid of the white matter's shares");
  }
  if (insulated.size() > 0 && !sameGrid(white.grid, insulated.grid)) {
    throw InvalidInput("insulated: not on the grid of the white matter's shares");
  }
  Mask inner(white.grid), all(white.grid), neither(white.grid);
  for (std::size_t v = 0; v < white.size(); ++v) {
    inner[v] = white[v] >= 0.5F;
    all[v] = inner[v] || (hasTissue && tissue[v] >= 0.5F);
    if (insulated.size() > 0) neither[v] = insulated[v] != 0 && !all[v];
  }
  CorticalTissue result;
  result.whiteVoxels = voxelsIn(inner);
  result.greyVoxels = voxelsIn(all) - result.whiteVoxels;
  if (result.whiteVoxels == 0) throw InvalidInput("white: no share reaches 0.5");

  Volume<float> own = white, both = hasTissue ? tissue : white;
  // Where the caller says what was cut off, the shares hold one hemisphere already.
  if (options.hemisphere && insulated.size() == 0) {
    const Mask sides = splitHemispheres(inner, monitor);
    result.cutContact = contactOf(sides);
    Mask reached = sides;
    spreadLabels(all, reached);
    const std::uint8_t side = *options.hemisphere == Side::Left ? 1 : 2;
    for (std::size_t v = 0; v < inner.size(); ++v) {
      // Beyond the cut shares are mirrored at one half, so that the cut lies between voxels.
      if (inner[v] && sides[v] != side) {
        own[v] = 1 - own[v];
        neither[v] = 1;
        inner[v] = 0;
      }
      if (all[v] && reached[v] != side) {
        both[v] = std::min(both[v], 1 - both[v]);
        all[v] = 0;
      }
    }
  }
  if (!options.hemisphere) warnOfTwoHemispheres(inner, monitor);
  result.atImageBorder = countOnEdge(all);
  requireInside(inner, options.closeEdges, monitor);
  constexpr int kMargin = 3;
  const VoxelBox box = boundingBox(all, kMargin);
  result.white = levelSetOf(crop(own, box, 0.0F));
  result.tissue = levelSetOf(crop(both, box, 0.0F));
  // White matter is tissue, whatever the shares say.
  for (std::size_t v = 0; v < result.white.size(); ++v) {
    result.tissue[v] = std::max(result.tissue[v], result.white[v]);
  }
  result.insulated = crop(neither, box);
  result.hasGrey = hasTissue && result.greyVoxels > 0;
  result.byBrightness = true;
  result.structure = !options.hemisphere                 ? "Cortex"
                     : *options.hemisphere == Side::Left ? "CortexLeft"
                                                         : "CortexRight";
  return result;
}

}  // namespace explica::surface
