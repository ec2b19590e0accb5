// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/SliceAlignment.h"

#include "IntactSlices.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace explica::ventricle {
namespace {

using Residuals = std::map<int, Eigen::Vector2d>;  // by slice, mm

/// Whether the slice shows the whole outline of the epicardium: a closed ring, or the cap of the
/// apex (a wall without cavity near the base is what an oblique base leaves of a ring).
bool isEnclosed(const Slice& slice, const Grid& grid, int k, const LongAxis& axis) {
  if (slice.kind != SliceKind::Cap) return slice.kind == SliceKind::Ring;
  const Eigen::Vector2d at = slice.centre.cwiseQuotient(grid.spacing.head<2>());
  return axis.share(grid.toWorld(Vector(at[0], at[1], k))) > 0.5;
}

/// Centroid of cavity and wall of a slice, mm along i and j.
Eigen::Vector2d enclosedCentre(const Volume<Label>& heart, int k) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double count = 0;
  for (int j = 0; j < heart.grid.size[1]; ++j) {
    for (int i = 0; i < heart.grid.size[0]; ++i) {
      const Label label = heart(i, j, k);
      if (label != kCavity && label != kWall) continue;
      sum += Eigen::Vector2d(i, j);
      count += 1;
    }
  }
  return (sum / count).cwiseProduct(heart.grid.spacing.head<2>());
}

/// What the centroids of closed rings and of the apex's cap are off their least-squares line.
Residuals offTheLine(const Volume<Label>& heart, LongAxis axis) {
  Residuals centres;
  const std::vector<Slice> slices = slicesOf(heart);
  axis = withEndsOf(axis, heart);
  const std::vector<bool> intact = intactSlices(slices, heart, axis);
  double meanSlice = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (int k = 0; k < static_cast<int>(slices.size()); ++k) {
    if (!isEnclosed(slices[k], heart.grid, k, axis) || !intact[k]) continue;
    centres[k] = enclosedCentre(heart, k);
    meanSlice += k;
    mean += centres[k];
  }
  const auto count = static_cast<double>(centres.size());
  if (centres.size() < 3) return {};
  meanSlice /= count;
  mean /= count;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  double squares = 0;
  for (const auto& [k, centre] : centres) {
    slope += (k - meanSlice) * (centre - mean);
    squares += (k - meanSlice) * (k - meanSlice);
  }
  slope /= squares;
  for (auto& [k, centre] : centres) centre -= mean + (k - meanSlice) * slope;
  return centres;
}

/// Standard error of a line's slope through `slices` consecutive centroids, each of that error.
double slopeError(double centroidError, double slices, double spacing) {
  return centroidError / (spacing * std::sqrt(slices * (slices * slices - 1) / 12));
}

}  // namespace

SliceAlignment alignSlices(const std::vector<Volume<Label>>& hearts, const LongAxis& axis) {
  std::vector<Residuals> frames;
  for (const Volume<Label>& heart : hearts) frames.push_back(offTheLine(heart, axis));
  SliceAlignment found;
  const Grid& grid = hearts.front().grid;
  found.shift.assign(static_cast<std::size_t>(grid.size[2]), Eigen::Vector2d::Zero());
  double squares = 0, slices = 0;
  for (int k = 0; k < grid.size[2]; ++k) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double count = 0;
    for (const Residuals& frame : frames) {
      const auto at = frame.find(k);
      if (at == frame.end()) continue;
      sum += at->second;
      count += 1;
    }
    if (count == 0) continue;
    found.shift[k] = sum / count;
    const double squared = found.shift[k].squaredNorm();
    squares += squared;
    slices += 1;
    found.largest = std::max(found.largest, std::sqrt(squared));
  }
  if (slices < 3) return found;
  found.rms = std::sqrt(squares / slices);
  const double coordinate = std::sqrt(squares / (2 * (slices - 2)));  // less a line's two numbers
  found.slopeErrorDeg = std::atan(slopeError(coordinate, slices, grid.spacing[2])) * 180 / kPi;
  return found;
}

}  // namespace explica::ventricle
