// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Registration/SkullStripping.h"

#include "BrainBorder.h"
#include "BrainBrightness.h"
#include "Explica/Core/Errors.h"
#include "Explica/Core/VoxelSets.h"
#include "Filters.h"

#include <algorithm>
#include <cmath>

namespace explica::registration {
namespace {

constexpr double kLeastSpacing = 1.5;  // mm of the grid that the border is sought on
constexpr double kNormals = 3;         // mm: smoothing of the distance whose gradient normals are
constexpr double kSpreading = 4;       // mm: window in which offsets of places become a field
constexpr float kFarWeight = 1e-3f;    // weight of a window three times as wide, between far places

/// A grid of cubes around the mask, wide enough for the profiles beyond it.
Grid gridAround(const Volume<float>& brain, double margin) {
  Vector low = Vector::Constant(kInfinity);
  Vector high = Vector::Constant(-kInfinity);
  for (std::size_t v = 0; v < brain.size(); ++v) {
    if (!(brain[v] > 0.5f)) continue;
    const auto [i, j, k] = brain.grid.subscripts(v);
    low = low.cwiseMin(Vector(i, j, k));
    high = high.cwiseMax(Vector(i, j, k));
  }
  if (!(low.x() <= high.x())) {
    throw InvalidInput("T1: the template's brain lies outside of the image");
  }
  const Vector around = margin * brain.grid.spacing.cwiseInverse();
  const double spacing = std::max(kLeastSpacing, std::cbrt(brain.grid.voxelVolume()));
  return cubicGrid(brain.grid, low - around, high + around, spacing);
}

/// 1 further than so many mm from the set.
VoxelSet beyond(const VoxelSet& set, double distance) {
  const Volume<float> squared = squaredDistanceTo(set);
  VoxelSet far(set.grid, 0);
  for (std::size_t v = 0; v < set.size(); ++v) far[v] = squared[v] > distance * distance ? 1 : 0;
  return far;
}

/// Signed distance to the border of the mask closed by a ball, mm, negative inside, smoothed.
Volume<float> distanceToHull(const Volume<float>& brain, double closing) {
  VoxelSet inside(brain.grid, 0);
  for (std::size_t v = 0; v < brain.size(); ++v) inside[v] = brain[v] > 0.5f ? 1 : 0;
  const VoxelSet hull = beyond(beyond(inside, closing), closing);
  VoxelSet outside(brain.grid, 0);
  for (std::size_t v = 0; v < hull.size(); ++v) outside[v] = hull[v] == 0 ? 1 : 0;
  const Volume<float> toHull = squaredDistanceTo(hull);
  const Volume<float> toOutside = squaredDistanceTo(outside);
  const auto half = static_cast<float>(0.5 * brain.grid.spacing.x());
  Volume<float> distance(brain.grid);
  for (std::size_t v = 0; v < hull.size(); ++v) {
    distance[v] = hull[v] != 0 ? half - std::sqrt(toOutside[v]) : std::sqrt(toHull[v]) - half;
  }
  return smoothed(std::move(distance), kNormals);
}

/// What is known at places, everywhere on a grid: the mean within a window.
Volume<float> spread(const std::vector<BorderPlace>& places, const Grid& grid,
                     double BorderPlace::*value) {
  Volume<float> weight(grid, 0.0f), sum(grid, 0.0f);
  double mean = 0;
  for (const BorderPlace& place : places) {
    const Vector at = grid.toIndex(place.foot);
    const std::size_t v =
        grid.linear(static_cast<int>(std::lround(at.x())), static_cast<int>(std::lround(at.y())),
                    static_cast<int>(std::lround(at.z())));
    weight[v] += 1;
    sum[v] += static_cast<float>(place.*value);
    mean += place.*value / static_cast<double>(places.size());
  }
  const Volume<float> wideWeight = smoothed(weight, 3 * kSpreading);
  const Volume<float> wideSum = smoothed(sum, 3 * kSpreading);
  weight = smoothed(std::move(weight), kSpreading);
  sum = smoothed(std::move(sum), kSpreading);
  for (std::size_t v = 0; v < sum.size(); ++v) {
    const float faint = kFarWeight * kFarWeight * kFarWeight;
    sum[v] = (sum[v] + kFarWeight * wideSum[v] + faint * static_cast<float>(mean)) /
             (weight[v] + kFarWeight * wideWeight[v] + faint);
  }
  return sum;
}

void summarise(const std::vector<BorderPlace>& places, BrainMask& result) {
  const auto count = static_cast<double>(places.size());
  double squared = 0;
  for (const BorderPlace& place : places) {
    result.meanOffset += place.offset / count;
    squared += place.deviation * place.deviation / count;
    result.openShare += place.open ? 1 / count : 0;
  }
  result.deviation = std::sqrt(squared);
}

}  // namespace

BrainMask stripSkull(const Volume<float>& image, const Volume<float>& brain,
                     const StrippingOptions& options) {
  const Grid grid = gridAround(brain, 2 * options.reach);
  Volume<float> distance = distanceToHull(resampled(brain, grid), options.closing);
  const BrainBrightness brightness = measureBrightness(resampled(image, grid), distance);
  const std::vector<BorderPlace> places =
      findBorder(brightness, distance, {.reach = options.reach});
  if (places.empty()) throw InvalidInput("T1: the template's brain is too small to be one");
  BrainMask result;
  summarise(places, result);
  const Volume<float> offset = spread(places, grid, &BorderPlace::offset);
  for (std::size_t v = 0; v < distance.size(); ++v) distance[v] -= offset[v];
  const Volume<float> deviation = spread(places, grid, &BorderPlace::deviation);
  result.mask = Volume<Label>(image.grid, 0);
  result.doubt = Volume<float>(image.grid, 0.0f);
  constexpr float kOutside = 1e6f;
  forLattice(image.grid, [&](int i, int j, int k) {
    const Vector at = grid.toIndex(image.grid.toWorld(Vector(i, j, k)));
    const float here = valueAt(distance, at, kOutside);
    result.mask(i, j, k) = here < 0 ? 1 : 0;
    if (std::abs(here) < kSpreading) result.doubt(i, j, k) = valueAt(deviation, at);
  });
  return result;
}

}  // namespace explica::registration
