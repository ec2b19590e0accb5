// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/SliceAlignment.h"

#include "IntactSlices.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace explica::ventricle {
namespace {

using Centres = std::map<int, Eigen::Vector2d>;  // by slice, mm along i and j

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

/// Of the closed rings and of the apex's cap.
Centres centresOf(const Volume<Label>& heart, LongAxis axis) {
  Centres centres;
  const std::vector<Slice> slices = slicesOf(heart);
  axis = withEndsOf(axis, heart);
  const std::vector<bool> intact = intactSlices(slices, heart, axis);
  for (int k = 0; k < static_cast<int>(slices.size()); ++k) {
    if (!isEnclosed(slices[k], heart.grid, k, axis) || !intact[k]) continue;
    centres[k] = enclosedCentre(heart, k);
  }
  return centres;
}

/// What is left of places beside their line of least squares along the slices.
Centres offTheLine(Centres places) {
  const auto count = static_cast<double>(places.size());
  double middle = 0, squares = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero(), slope = mean;
  for (const auto& [k, place] : places) middle += k / count, mean += place / count;
  for (const auto& [k, place] : places) {
    slope += (k - middle) * (place - mean);
    squares += (k - middle) * (k - middle);
  }
  for (auto& [k, place] : places) place -= mean + (k - middle) / squares * slope;
  return places;
}

/// Shifts of slices that, with a line for each frame, come nearest to all centres in the least
/// squares: lines and shifts in turn, since not every frame shows every slice.
Centres commonShifts(const std::vector<Centres>& frames) {
  constexpr int kRounds = 100;  // each brings them some tenths nearer
  Centres shifts;
  for (const Centres& frame : frames) {
    for (const auto& [k, centre] : frame) shifts[k] = Eigen::Vector2d::Zero();
  }
  for (int round = 0; round < kRounds; ++round) {
    std::map<int, double> count;
    Centres more;
    for (Centres rest : frames) {
      for (auto& [k, centre] : rest) centre -= shifts[k];
      for (const auto& [k, off] : offTheLine(std::move(rest))) {
        if (count[k]++ == 0) more[k] = Eigen::Vector2d::Zero();
        more[k] += off;
      }
    }
    for (const auto& [k, off] : more) shifts[k] += off / count[k];
  }
  return offTheLine(std::move(shifts));
}

/// Standard error of a line's slope through `slices` consecutive centroids, each of that error.
double slopeError(double centroidError, double slices, double spacing) {
  return centroidError / (spacing * std::sqrt(slices * (slices * slices - 1) / 12));
}

}  // namespace

SliceAlignment alignSlices(const std::vector<Volume<Label>>& hearts, const LongAxis& axis) {
  std::vector<Centres> frames;
  for (const Volume<Label>& heart : hearts) {
    frames.push_back(centresOf(heart, axis));
    if (frames.back().size() < 3) frames.pop_back();
  }
  SliceAlignment found;
  const Grid& grid = hearts.front().grid;
  found.shift.assign(static_cast<std::size_t>(grid.size[2]), Eigen::Vector2d::Zero());
  double squares = 0, slices = 0;
  for (const auto& [k, shift] : commonShifts(frames)) {
    found.shift[static_cast<std::size_t>(k)] = shift;
    squares += shift.squaredNorm();
    slices += 1;
    found.largest = std::max(found.largest, shift.norm());
  }
  if (slices < 3) return found;
  found.rms = std::sqrt(squares / slices);
  const double coordinate = std::sqrt(squares / (2 * (slices - 2)));  // less a line's two numbers
  found.slopeErrorDeg = std::atan(slopeError(coordinate, slices, grid.spacing[2])) * 180 / kPi;
  return found;
}

}  // namespace explica::ventricle
