// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Shapes/AnnulusBoundaries.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::shapes {
namespace {

constexpr int kVoxelsPerBand = 6;        // of the lattice on which distances are taken
constexpr int kMostVoxels = 1200;        // of its side
constexpr int kMostBoundaryEdges = 400;  // finer than the map of the annulus divides them

/// How deep a point lies within a closed polygon, mm, negative outside.
double depthIn(const planar::Curve& curve, const planar::Point2& q) {
  return (planar::encloses(curve, q) ? 1 : -1) * planar::distanceTo(curve, q);
}

planar::Curve largest(std::vector<planar::Curve> contours) {
  planar::Curve curve = std::move(contours.front());
  if (curve.vertexCount() > kMostBoundaryEdges) {
    curve = planar::resampled(curve, kMostBoundaryEdges);
  }
  return curve;
}

}  // namespace

AnnulusBoundaries boundariesOfTissue(const Volume<Label>& labels, const std::vector<Label>& inner,
                                     const std::vector<Label>& tissue, int slice,
                                     const planar::ContourOptions& options) {
  if (inner.empty() || tissue.empty()) {
    throw InvalidInput("annulus: labels of what it encloses and of its tissue are needed");
  }
  std::vector<Label> both = inner;
  both.insert(both.end(), tissue.begin(), tissue.end());
  return {largest(planar::contoursOfLabels(labels, inner, slice, options)),
          largest(planar::contoursOfLabels(labels, both, slice, options))};
}

AnnulusBoundaries bandAround(const std::vector<planar::Curve>& targets, double band) {
  if (targets.empty()) throw InvalidInput("band: no target to lay it around");
  if (!(band > 0)) throw InvalidInput("band: its width must be positive");
  planar::Point2 low = planar::Point2::Constant(kInfinity);
  planar::Point2 high = -low;
  for (const planar::Curve& target : targets) {
    low = low.cwiseMin(target.positions.colwise().minCoeff().transpose());
    high = high.cwiseMax(target.positions.colwise().maxCoeff().transpose());
  }
  const double spacing = band / kVoxelsPerBand;
  low.array() -= band + 2 * spacing;
  high.array() += band + 2 * spacing;
  const planar::Point2 count = ((high - low) / spacing).array().ceil() + 1;
  if (!(count.maxCoeff() <= kMostVoxels)) {
    throw InvalidInput("band: " + std::to_string(band) + " mm is too narrow for targets of " +
                       std::to_string((high - low).maxCoeff()) + " mm");
  }
  Grid grid;
  grid.size = {static_cast<int>(count.x()), static_cast<int>(count.y()), 1};
  grid.spacing = Vector::Constant(spacing);
  grid.origin = {low.x(), low.y(), 0};
  // Contours run around high values: depths within, of all targets and of any of them.
  Volume<float> withinAll(grid);
  Volume<float> withinAny(grid);
  parallelFor(withinAll.size(), 256, [&](std::size_t v) {
    const auto [i, j, k] = grid.subscripts(v);
    const planar::Point2 q = low + spacing * planar::Point2(i, j);
    double all = kInfinity;
    double any = -kInfinity;
    for (const planar::Curve& target : targets) {
      const double depth = depthIn(target, q);
      all = std::min(all, depth);
      any = std::max(any, depth);
    }
    withinAll[v] = static_cast<float>(all);
    withinAny[v] = static_cast<float>(any);
  });
  const std::vector<planar::Curve> inner = planar::contoursOfSlice(withinAll, 0, band);
  if (inner.size() != 1) {
    throw InvalidInput("band: moved inward by " + std::to_string(band) + " mm the targets have " +
                       (inner.empty() ? std::string("no common region left")
                                      : std::to_string(inner.size()) + " separate regions") +
                       "; a narrower band is needed");
  }
  return {largest(inner), largest(planar::contoursOfSlice(withinAny, 0, -band))};
}

}  // namespace explica::shapes
