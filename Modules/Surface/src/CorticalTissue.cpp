// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/CorticalTissue.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Surface/Measures.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <queue>
#include <set>

namespace explica::surface {
namespace {

using Mask = Volume<std::uint8_t>;
using Labels = std::vector<Label>;

/// One hemisphere in FreeSurfer's numbering (FreeSurferColorLUT).
struct SidedLabels {
  Labels white, grey, fill;
};

const SidedLabels& freeSurferLabels(Side side) {
  // Cerebral white; cortex; ventricles, thalamus (old and new number), caudate, putamen, pallidum,
  // hippocampus, amygdala, accumbens, ventral diencephalon, vessel, choroid plexus,
  // hypointensities.
  static const SidedLabels left = {
      {2}, {3}, {4, 5, 9, 10, 11, 12, 13, 17, 18, 26, 28, 30, 31, 78, 81}};
  static const SidedLabels right = {
      {41}, {42}, {43, 44, 48, 49, 50, 51, 52, 53, 54, 58, 60, 62, 63, 79, 82}};
  return side == Side::Left ? left : right;
}

/// Callosum, fornix, white-matter hypointensities, fifth ventricle: each voxel goes to the nearer
/// hemisphere.
const Labels& unsidedLabels() {
  static const Labels labels = {72, 77, 80, 250, 251, 252, 253, 254, 255};
  return labels;
}

using Histogram = std::map<Label, std::int64_t>;

/// Labels from `first` to `last` that a parcellation puts in the place of one tissue's label.
struct Parcels {
  Side side;
  bool white;
  Label first, last;
};

/// Regions of FreeSurfer's `aparc+aseg`, `aparc.a2009s+aseg` and `wmparc`, and what wmparc leaves
/// over of white matter.
constexpr std::array kParcels = {
    Parcels{Side::Left, false, 1000, 1035},  Parcels{Side::Left, false, 11100, 11175},
    Parcels{Side::Right, false, 2000, 2035}, Parcels{Side::Right, false, 12100, 12175},
    Parcels{Side::Left, true, 3000, 3035},   Parcels{Side::Left, true, 13100, 13175},
    Parcels{Side::Right, true, 4000, 4035},  Parcels{Side::Right, true, 14100, 14175},
    Parcels{Side::Left, true, 5001, 5001},   Parcels{Side::Right, true, 5002, 5002}};

/// One tissue's label of a hemisphere, and the parcels that are present beside it or for it.
Labels withParcels(const Histogram& histogram, Side side, bool white) {
  const SidedLabels& own = freeSurferLabels(side);
  Labels labels = white ? own.white : own.grey;
  const std::size_t plain = labels.size();
  for (const Parcels& parcels : kParcels) {
    if (parcels.side != side || parcels.white != white) continue;
    const auto end = histogram.upper_bound(parcels.last);
    for (auto it = histogram.lower_bound(parcels.first); it != end; ++it) {
      labels.push_back(it->first);
    }
  }
  // With parcels the plain label need not be there.
  if (labels.size() > plain) {
    std::erase_if(labels, [&](Label label) { return !histogram.contains(label); });
  }
  return labels;
}

Histogram histogramOf(const Volume<Label>& labels) {
  Histogram counts;
  Label last = 0;
  std::int64_t run = 0;
  for (const Label value : labels.data) {
    if (value != last) {
      counts[last] += run;
      last = value;
      run = 0;
    }
    ++run;
  }
  counts[last] += run;
  std::erase_if(counts, [](const auto& entry) { return entry.second == 0; });
  return counts;
}

std::int64_t countOf(const Histogram& histogram, const Labels& labels) {
  std::int64_t sum = 0;
  for (const Label label : std::set<Label>(labels.begin(), labels.end())) {
    const auto it = histogram.find(label);
    if (it != histogram.end()) sum += it->second;
  }
  return sum;
}

std::string listOf(const Histogram& histogram) {
  std::string text;
  int listed = 0;
  for (const auto& [label, count] : histogram) {
    if (++listed > 24) return text + ", ...";
    if (!text.empty()) text += ", ";
    text += std::to_string(label);
  }
  return text;
}

void requirePresent(const Histogram& histogram, const Labels& labels, const std::string& name) {
  for (const Label label : labels) {
    if (!histogram.contains(label)) {
      throw InvalidInput(name + ": label " + std::to_string(label) + " absent (found " +
                         listOf(histogram) + ")");
    }
  }
}

LabelPreset guessPreset(const Histogram& histogram) {
  const auto has = [&](Label label) { return histogram.contains(label); };
  // FreeSurfer gives label 1 to nothing.
  if (has(1) && has(2) && has(3) && histogram.rbegin()->first <= 4) return LabelPreset::ThreeClass;
  const auto hasBoth = [&](Side side) {
    const auto hasSome = [&](bool white) {
      const Labels labels = withParcels(histogram, side, white);
      return std::any_of(labels.begin(), labels.end(), has);
    };
    return hasSome(true) && hasSome(false);
  };
  const bool freeSurfer = hasBoth(Side::Left) || hasBoth(Side::Right);
  if (freeSurfer && (has(41) || has(10) || has(4))) {
    return has(10) || has(49) || has(4) || has(43) ? LabelPreset::Aseg : LabelPreset::Ribbon;
  }
  if (has(2) && has(3) && histogram.rbegin()->first <= 4) return LabelPreset::ThreeClass;
  if (has(110) || (has(127) && has(255))) return LabelPreset::Wm;
  if (freeSurfer) return LabelPreset::Ribbon;
  throw InvalidInput("labels: no preset fits (found " + listOf(histogram) +
                     "); name --white and --grey");
}

Mask maskOf(const Volume<Label>& volume, const Labels& labels) {
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

std::int64_t countIn(const Mask& mask) {
  return std::count_if(mask.data.begin(), mask.data.end(), [](std::uint8_t m) { return m != 0; });
}

std::int64_t countOnEdge(const Mask& mask) {
  const auto& n = mask.grid.size;
  std::int64_t count = 0;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      const bool wholeRow = k == 0 || j == 0 || k == n[2] - 1 || j == n[1] - 1;
      for (int i = 0; i < n[0]; i += wholeRow ? 1 : std::max(1, n[0] - 1)) {
        count += mask(i, j, k) != 0;
      }
    }
  }
  return count;
}

void requireInside(const Mask& mask, bool closeEdges, const Monitor& monitor) {
  const std::int64_t atEdge = countOnEdge(mask);
  if (atEdge == 0) return;
  const std::string found =
      "white matter touches the edge of the field of view at " + std::to_string(atEdge) + " voxels";
  if (!closeEdges) {
    throw InvalidInput(found +
                       "; the surface needs background around it: give a larger field of "
                       "view, or --close-edges to close it there");
  }
  monitor.warn(found + "; the surface is closed there");
}

/// Waves from labelled voxels through a mask, one label each, nearest first; distances in mm along
/// the six axes' steps.
void spreadLabels(const Mask& through, Mask& labels) {
  const Grid& grid = through.grid;
  const auto& n = grid.size;
  std::vector<float> arrival(through.size(), std::numeric_limits<float>::infinity());
  using Entry = std::pair<float, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
  for (std::size_t v = 0; v < through.size(); ++v) {
    if (labels[v]) {
      arrival[v] = 0;
      front.emplace(0.0F, static_cast<std::uint32_t>(v));
    }
  }
  while (!front.empty()) {
    const auto [time, v] = front.top();
    front.pop();
    if (time > arrival[v]) continue;
    const auto at = grid.subscripts(v);
    for (int dk = -1; dk <= 1; ++dk) {
      for (int dj = -1; dj <= 1; ++dj) {
        for (int di = -1; di <= 1; ++di) {
          const int i = at[0] + di, j = at[1] + dj, k = at[2] + dk;
          if (i < 0 || j < 0 || k < 0 || i >= n[0] || j >= n[1] || k >= n[2]) continue;
          const std::size_t w = grid.linear(i, j, k);
          if (!through[w]) continue;
          const float step =
              static_cast<float>(Vector(di, dj, dk).cwiseProduct(grid.spacing).norm());
          if (time + step < arrival[w]) {
            arrival[w] = time + step;
            labels[w] = labels[v];
            front.emplace(arrival[w], static_cast<std::uint32_t>(w));
          }
        }
      }
    }
  }
}

/// A plane near the middle and near sagittal: signed distance is n . x - offset, left negative.
struct Plane {
  Vector normal = Vector::UnitX();
  double offset = 0;
};

/// The near-sagittal plane through the middle of the mask that holds least of it.
/// @param unit  a millimetre in a human brain, mm
Plane leastWhitePlane(const std::vector<Point>& points, const Point& centre, double thickness,
                      double unit) {
  Plane best;
  double least = kInfinity;
  const auto search = [&](double yaw0, double roll0, double shift0, double angle, double shift,
                          int steps) {
    double bestYaw = yaw0, bestRoll = roll0, bestShift = shift0;
    for (int y = -steps; y <= steps; ++y) {
      for (int r = -steps; r <= steps; ++r) {
        const double yaw = yaw0 + y * angle, roll = roll0 + r * angle;
        const Vector normal = Vector(1, std::tan(yaw), std::tan(roll)).normalized();
        // One pass over the points serves all shifts.
        const int bins = 2 * steps + 1;
        std::vector<double> held(bins, 0);
        for (const Point& p : points) {
          const double d = normal.dot(p - centre) - shift0;
          const double nearest = std::round(d / shift);
          if (std::abs(nearest) <= steps && std::abs(d - nearest * shift) <= thickness) {
            held[static_cast<int>(nearest) + steps] += 1;
          }
        }
        for (int s = 0; s < bins; ++s) {
          const double at = shift0 + (s - steps) * shift;
          // A plane far from the middle is not it, however empty.
          const double cost =
              held[s] + 1e-5 * static_cast<double>(points.size()) * (at * at) / (unit * unit);
          if (cost < least) {
            least = cost;
            bestYaw = yaw;
            bestRoll = roll;
            bestShift = at;
            best.normal = normal;
            best.offset = normal.dot(centre) + at;
          }
        }
      }
    }
    return std::array{bestYaw, bestRoll, bestShift};
  };
  const auto coarse = search(0, 0, 0, 0.05, 2.0 * unit, 5);
  least = kInfinity;
  search(coarse[0], coarse[1], coarse[2], 0.015, 2.0 / 3 * unit, 3);
  return best;
}

void sortUnique(Labels& labels) {
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
}

/// Adds the voxels without side that are nearer to `own` than to `other`.
std::int64_t addNearer(const Mask& unsided, Mask& own, const Mask& other) {
  if (countIn(unsided) == 0) return 0;
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

/// One label for the whole brain is legal, and seldom what was meant: says what was found.
void warnOfTwoHemispheres(const Mask& white, const Monitor& monitor) {
  constexpr double kBrain = 150000;  // mm^3 of white matter: more than one hemisphere's least
  if (static_cast<double>(countIn(white)) * white.grid.voxelVolume() < kBrain) return;
  std::int64_t left = 0, right = 0;
  try {
    const Mask sides = splitHemispheres(white);
    left = std::count(sides.data.begin(), sides.data.end(), 1);
    right = std::count(sides.data.begin(), sides.data.end(), 2);
  } catch (const InvalidInput&) {
    return;  // not two hemispheres: nothing to say
  }
  if (std::min(left, right) * 3 < std::max(left, right) * 2) return;
  monitor.warn("white matter may hold two hemispheres (" + std::to_string(left) + " voxels left, " +
               std::to_string(right) +
               " right of the plane with least white matter); --hemisphere L or R takes one");
}

}  // namespace

Volume<float> sharesOf(const Volume<float>& scalars, std::optional<double> level,
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
  const auto& n = scalars.grid.size;
  std::int64_t above = 0, below = 0;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      const bool wholeRow = k == 0 || j == 0 || k == n[2] - 1 || j == n[1] - 1;
      for (int i = 0; i < n[0]; i += wholeRow ? 1 : std::max(1, n[0] - 1)) {
        ++(scalars(i, j, k) > boundary ? above : below);
      }
    }
  }
  const double sign = above <= below ? 1 : -1;
  Volume<float> share(scalars.grid);
  parallelFor(share.size(), 1 << 18, [&](std::size_t v) {
    share[v] =
        static_cast<float>(std::clamp(0.5 + sign * (scalars[v] - boundary) / scale, 0.0, 1.0));
  });
  return share;
}

Volume<float> addShares(const Volume<float>& a, const Volume<float>& b) {
  if (!sameGrid(a.grid, b.grid)) {
    throw InvalidInput("shares: white and grey matter are on different grids");
  }
  Volume<float> sum(a.grid);
  parallelFor(sum.size(), 1 << 18, [&](std::size_t v) { sum[v] = std::min(1.0F, a[v] + b[v]); });
  return sum;
}

Volume<std::uint8_t> splitHemispheres(const Volume<std::uint8_t>& white, const Monitor& monitor) {
  const Grid& grid = white.grid;
  std::vector<Point> points;
  Point centre = Point::Zero();
  for (std::size_t v = 0; v < white.size(); ++v) {
    if (!white[v]) continue;
    const auto at = grid.subscripts(v);
    points.push_back(grid.toWorld(Vector(at[0], at[1], at[2])));
    centre += points.back();
  }
  if (points.empty()) throw InvalidInput("hemisphere: no white matter to separate");
  centre /= static_cast<double>(points.size());
  std::vector<Point> some;
  const std::size_t stride = std::max<std::size_t>(1, points.size() / 60000);
  for (std::size_t p = 0; p < points.size(); p += stride) some.push_back(points[p]);
  // Lengths are those of a human brain, whose white matter has the volume of a ball of 48 mm.
  constexpr double kHuman = 48;
  const double unit = radiusOfVoxels(static_cast<std::int64_t>(points.size()), grid) / kHuman;
  const Plane plane = leastWhitePlane(some, centre, 0.5 * grid.spacing.maxCoeff(), unit);

  Volume<std::uint8_t> sides(grid);
  const double sure = 10 * unit;  // from the plane: no gyrus bulges that far
  for (std::size_t v = 0; v < white.size(); ++v) {
    if (!white[v]) continue;
    const auto at = grid.subscripts(v);
    const double d = plane.normal.dot(grid.toWorld(Vector(at[0], at[1], at[2]))) - plane.offset;
    if (std::abs(d) > sure) sides[v] = d < 0 ? 1 : 2;
  }
  spreadLabels(white, sides);
  const auto left = std::count(sides.data.begin(), sides.data.end(), 1);
  const auto right = std::count(sides.data.begin(), sides.data.end(), 2);
  if (10 * std::min(left, right) < left + right) {
    throw InvalidInput("hemisphere: white matter does not hold two hemispheres (" +
                       std::to_string(left) + " voxels left, " + std::to_string(right) +
                       " right of the plane with least white matter)");
  }
  monitor.progress(1.0, "hemispheres separated");
  return sides;
}

CorticalTissue tissueFromLabels(const Volume<Label>& labels, const TissueOptions& options,
                                const Monitor& monitor) {
  if (labels.grid.dimension() != 3) {
    throw InvalidInput("labels: one slice; a surface needs a volume");
  }
  const Histogram histogram = histogramOf(labels);
  LabelPreset preset = options.preset;
  if (preset == LabelPreset::Auto) {
    preset = options.white.empty() ? guessPreset(histogram) : LabelPreset::None;
  }
  const bool sided = preset == LabelPreset::Aseg || preset == LabelPreset::Ribbon;

  Labels white = options.white, grey = options.grey, fill = options.fill;
  Labels insulated = options.insulated, unsided, otherWhite;
  bool split = false;
  if (sided) {
    const std::int64_t left = countOf(histogram, withParcels(histogram, Side::Left, true));
    const std::int64_t right = countOf(histogram, withParcels(histogram, Side::Right, true));
    if (!options.hemisphere && left > 0 && right > 0 && options.white.empty()) {
      throw InvalidInput("labels: both hemispheres are present (white matter " +
                         std::to_string(left) + " voxels left, " + std::to_string(right) +
                         " right); choose --hemisphere L or R");
    }
    const Side side = options.hemisphere.value_or(left > 0 ? Side::Left : Side::Right);
    const SidedLabels& own = freeSurferLabels(side);
    const Side otherSide = side == Side::Left ? Side::Right : Side::Left;
    const SidedLabels& other = freeSurferLabels(otherSide);
    const Labels beyond = withParcels(histogram, otherSide, true);
    if (white.empty()) white = withParcels(histogram, side, true);
    if (grey.empty()) grey = withParcels(histogram, side, false);
    if (fill.empty() && preset == LabelPreset::Aseg && !options.noFill) {
      fill = own.fill;
      unsided = unsidedLabels();
    }
    if (insulated.empty()) {
      insulated = beyond;
      insulated.insert(insulated.end(), other.fill.begin(), other.fill.end());
      insulated.push_back(16);  // brain stem
    }
    otherWhite = beyond;
    otherWhite.insert(otherWhite.end(), other.fill.begin(), other.fill.end());
  } else if (preset == LabelPreset::ThreeClass) {
    if (white.empty()) white = {3};
    if (grey.empty()) grey = {2};
    if (insulated.empty() && histogram.contains(4)) insulated = {4};
    split = options.hemisphere.has_value();
  } else if (preset == LabelPreset::Wm) {
    const bool filled = histogram.contains(255) && histogram.contains(127) && histogram.size() <= 4;
    if (filled && white.empty()) {
      if (!options.hemisphere) {
        throw InvalidInput("labels: both hemispheres are present (" +
                           std::to_string(histogram.at(255)) + " voxels left, " +
                           std::to_string(histogram.at(127)) +
                           " right); choose --hemisphere L or R");
      }
      white = {*options.hemisphere == Side::Left ? 255 : 127};
    } else if (white.empty()) {
      constexpr Label kLeastWhite = 5;  // FreeSurfer's threshold of wm.mgz
      for (const auto& [label, count] : histogram) {
        if (label >= kLeastWhite) white.push_back(label);
      }
      split = options.hemisphere.has_value();
    }
  } else {
    if (white.empty()) throw InvalidInput("white: no label named");
    split = options.hemisphere.has_value();
  }
  if (options.white.empty()) {
    if (countOf(histogram, white) == 0) requirePresent(histogram, {white.front()}, "white");
  } else {
    requirePresent(histogram, white, "white");
  }
  if (!options.grey.empty() || !grey.empty()) requirePresent(histogram, grey, "grey");
  if (!options.fill.empty()) requirePresent(histogram, fill, "fill");
  if (!options.insulated.empty()) requirePresent(histogram, insulated, "insulated");
  sortUnique(white);
  sortUnique(grey);
  sortUnique(fill);
  for (const Label label : grey) {
    if (std::binary_search(white.begin(), white.end(), label) ||
        std::binary_search(fill.begin(), fill.end(), label)) {
      throw InvalidInput("grey: label " + std::to_string(label) + " is also white or filled");
    }
  }

  monitor.progress(0.1, "labels");
  Mask inner = maskOf(labels, white);
  Mask ribbon = maskOf(labels, grey);
  Mask neither = maskOf(labels, insulated);
  CorticalTissue result;
  result.whiteVoxels = countIn(inner);
  if (!fill.empty() || !unsided.empty()) {
    const Mask filled = maskOf(labels, fill);
    for (std::size_t v = 0; v < inner.size(); ++v) {
      if (filled[v] && !inner[v]) {
        inner[v] = 1;
        ++result.filledVoxels;
      }
    }
    result.filledVoxels += addNearer(maskOf(labels, unsided), inner, maskOf(labels, otherWhite));
  }

  if (split) {
    monitor.progress(0.3, "separating hemispheres");
    Mask sides = splitHemispheres(inner, monitor);
    Mask all = sides;
    Mask through(labels.grid);
    for (std::size_t v = 0; v < through.size(); ++v) through[v] = inner[v] || ribbon[v];
    spreadLabels(through, all);
    const std::uint8_t own = *options.hemisphere == Side::Left ? 1 : 2;
    const auto& n = labels.grid.size;
    for (int k = 0; k + 1 < n[2]; ++k) {
      for (int j = 0; j + 1 < n[1]; ++j) {
        for (int i = 0; i + 1 < n[0]; ++i) {
          for (const auto other : {sides(i + 1, j, k), sides(i, j + 1, k), sides(i, j, k + 1)}) {
            result.cutContact += sides(i, j, k) + other == 3 && sides(i, j, k) && other;
          }
        }
      }
    }
    for (std::size_t v = 0; v < inner.size(); ++v) {
      if (inner[v] && sides[v] != own) {
        inner[v] = 0;
        neither[v] = 1;
      }
      if (ribbon[v] && all[v] != own) ribbon[v] = 0;
    }
  } else if (!sided && !options.hemisphere) {
    warnOfTwoHemispheres(inner, monitor);
  }

  if (countIn(inner) == 0) {
    throw InvalidInput("white: no voxel left after separation (labelled white: " +
                       std::to_string(result.whiteVoxels) + " voxels)");
  }
  requireInside(inner, options.closeEdges, monitor);
  result.greyVoxels = countIn(ribbon);
  Mask tissue = inner;
  for (std::size_t v = 0; v < tissue.size(); ++v) {
    tissue[v] = inner[v] || ribbon[v];
    if (tissue[v]) neither[v] = 0;
  }

  monitor.progress(0.7, "level sets");
  CorticalTissue levels = assemble(inner, tissue, neither);
  result.white = std::move(levels.white);
  result.tissue = std::move(levels.tissue);
  result.insulated = std::move(levels.insulated);
  result.preset = preset;
  result.hasGrey = result.greyVoxels > 0;
  if (options.hemisphere) {
    result.structure = *options.hemisphere == Side::Left ? "CortexLeft" : "CortexRight";
  } else if (sided) {
    const Labels left = withParcels(histogram, Side::Left, true);
    const bool isLeft = std::find(left.begin(), left.end(), white.front()) != left.end();
    result.structure = isLeft ? "CortexLeft" : "CortexRight";
  } else {
    result.structure = "Cortex";
  }
  monitor.progress(1.0, "level sets");
  return result;
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
  result.whiteVoxels = countIn(inner);
  result.greyVoxels = countIn(all) - result.whiteVoxels;
  if (result.whiteVoxels == 0) throw InvalidInput("white: no share reaches 0.5");

  Volume<float> own = white, both = hasTissue ? tissue : white;
  // Where the caller says what was cut off, the shares hold one hemisphere already.
  if (options.hemisphere && insulated.size() == 0) {
    const Mask sides = splitHemispheres(inner, monitor);
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
  result.structure = !options.hemisphere                 ? "Cortex"
                     : *options.hemisphere == Side::Left ? "CortexLeft"
                                                         : "CortexRight";
  return result;
}

}  // namespace explica::surface
