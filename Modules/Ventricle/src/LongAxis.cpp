// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/LongAxis.h"

#include "Explica/Core/Errors.h"
#include "Explica/Ventricle/Stack.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <vector>

namespace explica::ventricle {

namespace {

constexpr double kThick = 3;          // slices over pixels
constexpr int kSlabs = 12;            // across the axis
constexpr int kRounds = 30;           // of the search for the axis, which converges linearly
constexpr double kEndShare = 0.0005;  // of the cavity beyond the apical end: a few voxels' noise
constexpr double kBaseShare = 0.002;  // beyond the basal end, which is broad

/// A centroid and how much it counts.
struct Centroid {
  Point at = Point::Zero();
  double weight = 0;
};

struct Line {
  Point centre = Point::Zero();
  Vector direction = Vector::Zero();
  double spread = 0;
};

/// How far slice k was moved, RAS mm.
Vector moved(const Grid& grid, const SliceShifts& shift, int k) {
  if (k < 0 || k >= static_cast<int>(shift.size())) return Vector::Zero();
  return grid.direction.leftCols<2>() * shift[static_cast<std::size_t>(k)];
}

/// Main axis of weighted points.
Line mainAxis(const std::vector<Centroid>& points) {
  Line line;
  double sum = 0;
  for (const Centroid& c : points) sum += c.weight, line.centre += c.weight * c.at;
  line.centre /= sum;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Centroid& c : points) {
    spread += c.weight * (c.at - line.centre) * (c.at - line.centre).transpose() / sum;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  line.direction = solver.eigenvectors().col(2);
  line.spread = std::sqrt(std::max(0.0, solver.eigenvalues()[0] + solver.eigenvalues()[1]));
  return line;
}

/// Centres of the cavity's voxels with the slices put straight.
std::vector<Point> cavityPoints(const Volume<Label>& heart, const SliceShifts& shift) {
  std::vector<Point> points;
  for (std::size_t v = 0; v < heart.size(); ++v) {
    if (heart[v] != kCavity) continue;
    const auto s = heart.grid.subscripts(v);
    points.push_back(centreOf(heart.grid, v) - moved(heart.grid, shift, s[2]));
  }
  return points;
}

Point meanOf(const std::vector<Point>& points) {
  Point sum = Point::Zero();
  for (const Point& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

/// Along the centroids of closed rings, or of open ones too where fewer than three are closed; the
/// normal of the slices where fewer than two are left.
Line axisOfSlices(const Volume<Label>& heart, const SliceShifts& shift,
                  const std::vector<Point>& cavity) {
  std::vector<Centroid> centroids;
  const std::vector<Slice> slices = slicesOf(heart);
  const auto closed = std::count_if(slices.begin(), slices.end(),
                                    [](const Slice& s) { return s.kind == SliceKind::Ring; });
  for (std::size_t k = 0; k < slices.size(); ++k) {
    if (closed >= 3 ? slices[k].kind != SliceKind::Ring : !slices[k].whole()) continue;
    const Eigen::Vector2d index = slices[k].centre.cwiseQuotient(heart.grid.spacing.head<2>());
    centroids.push_back({heart.grid.toWorld(Vector(index[0], index[1], static_cast<double>(k))) -
                             moved(heart.grid, shift, static_cast<int>(k)),
                         static_cast<double>(slices[k].cavity)});
  }
  if (centroids.size() < 2) return {meanOf(cavity), heart.grid.direction.col(2), 0};
  return mainAxis(centroids);
}

/// Points that fill the cavity evenly: a thick slice's voxels are divided along k.
std::vector<Point> filledCavity(const Volume<Label>& heart, const std::vector<Point>& cavity) {
  const double thin = heart.grid.spacing.head<2>().maxCoeff();
  const int parts = std::max(1, static_cast<int>(std::lround(heart.grid.spacing[2] / thin)));
  const Vector step = heart.grid.spacing[2] / parts * heart.grid.direction.col(2);
  std::vector<Point> points;
  for (const Point& p : cavity) {
    for (int part = 0; part < parts; ++part)
      points.push_back(p + (part - 0.5 * (parts - 1)) * step);
  }
  return points;
}

/// Along the centroids of slabs across the axis, the outermost left out: a base that is cut
/// obliquely shifts them.
Line axisOfSlabs(const std::vector<Point>& cavity, Line line) {
  for (int round = 0; round < kRounds; ++round) {
    double low = kInfinity, high = -kInfinity;
    for (const Point& p : cavity) {
      const double h = (p - line.centre).dot(line.direction);
      low = std::min(low, h), high = std::max(high, h);
    }
    std::vector<Centroid> slabs(kSlabs);
    for (const Point& p : cavity) {
      const double h = (p - line.centre).dot(line.direction);
      const int slab =
          std::clamp(static_cast<int>(kSlabs * (h - low) / (high - low)), 0, kSlabs - 1);
      slabs[slab].at += p;
      ++slabs[slab].weight;
    }
    std::vector<Centroid> kept;
    for (int s = 1; s + 1 < kSlabs; ++s) {
      if (slabs[s].weight > 0) kept.push_back({slabs[s].at / slabs[s].weight, slabs[s].weight});
    }
    if (kept.size() < 2) break;
    const Vector before = line.direction;
    line = mainAxis(kept);
    if (std::abs(before.dot(line.direction)) > 1 - 1e-10) break;
  }
  return line;
}

/// Where the search for the axis begins.
Line firstAxis(const Volume<Label>& heart, const SliceShifts& shift,
               const std::vector<Point>& cavity) {
  if (hasThickSlices(heart.grid)) return axisOfSlices(heart, shift, cavity);
  std::vector<Centroid> all;
  for (const Point& p : cavity) all.push_back({p, 1});
  return mainAxis(all);
}

/// Heights of the cavity's voxel centres along an axis, sorted.
std::vector<double> heightsAlong(const LongAxis& axis, const std::vector<Point>& cavity) {
  std::vector<double> heights;
  for (const Point& p : cavity) heights.push_back((p - axis.centre).dot(axis.direction));
  std::sort(heights.begin(), heights.end());
  return heights;
}

/// How far the basal end lies beyond the last voxel centres, in the mean: half a slice where slices
/// are across the axis, nothing where one slice reaches over more than that height.
double gapAtBase(const LongAxis& axis, const Volume<Label>& heart) {
  std::size_t widest = 0;
  for (const Slice& slice : slicesOf(heart)) widest = std::max(widest, slice.cavity);
  const double width = 2 * std::sqrt(static_cast<double>(widest) * heart.grid.spacing[0] *
                                     heart.grid.spacing[1] / kPi);
  const double cosine = std::abs(heart.grid.direction.col(2).dot(axis.direction));
  const double sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  return std::max(0.0, 0.5 * (heart.grid.spacing[2] * cosine - width * sine));
}

bool isThickAlong(const Grid& grid, int axis) {
  return grid.spacing[axis] >=
         kThick * std::max(grid.spacing[(axis + 1) % 3], grid.spacing[(axis + 2) % 3]);
}

}  // namespace

bool hasThickSlices(const Grid& grid) {
  return isThickAlong(grid, 2);
}

int sliceAxis(const Grid& grid) {
  return isThickAlong(grid, 0) ? 0 : isThickAlong(grid, 1) ? 1 : 2;
}

Vector LongAxis::shiftAt(const Point& x) const {
  if (shift.empty()) return Vector::Zero();
  const double slice = (x - grid.origin).dot(grid.direction.col(2)) / grid.spacing[2];
  return moved(grid, shift, static_cast<int>(std::lround(slice)));
}

LongAxis withEndsOf(LongAxis axis, const Volume<Label>& heart) {
  const std::vector<double> heights = heightsAlong(axis, cavityPoints(heart, axis.shift));
  if (heights.empty()) return axis;
  const auto count = static_cast<double>(heights.size());
  const double half =
      0.5 * heart.grid.spacing[2] * std::abs(heart.grid.direction.col(2).dot(axis.direction));
  axis.base = heights[static_cast<std::size_t>(kBaseShare * count)] - gapAtBase(axis, heart);
  axis.apex = heights[static_cast<std::size_t>((1 - kEndShare) * count)] + half;
  return axis;
}

LongAxis findLongAxis(const Volume<Label>& heart, const SliceShifts& shift) {
  const std::vector<Point> cavity = cavityPoints(heart, shift);
  if (cavity.empty()) throw InvalidInput("the left ventricle's cavity is empty");
  const Line line = axisOfSlabs(filledCavity(heart, cavity), firstAxis(heart, shift, cavity));
  LongAxis axis{.centre = meanOf(cavity), .grid = heart.grid, .shift = shift};
  axis.centre = line.centre + (axis.centre - line.centre).dot(line.direction) * line.direction;
  axis.direction = line.direction.normalized();
  axis.spreadMm = line.spread;
  axis.stackAngleDeg =
      std::acos(std::min(1.0, std::abs(axis.direction.dot(heart.grid.direction.col(2))))) * 180 /
      kPi;
  // The tapered half holds less than half of the cavity.
  const std::vector<double> heights = heightsAlong(axis, cavity);
  const double middle = 0.5 * (heights.front() + heights.back());
  const auto below = std::lower_bound(heights.begin(), heights.end(), middle) - heights.begin();
  if (2 * below < static_cast<std::ptrdiff_t>(heights.size())) axis.direction = -axis.direction;
  return withEndsOf(axis, heart);
}

}  // namespace explica::ventricle
