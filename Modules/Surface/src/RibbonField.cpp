// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "RibbonField.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Harmonic/Interpolant.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::surface {
namespace {

/// Fronts meet head-on if the angle between their normals is more than this (cosine).
constexpr float kHeadOn = -0.5F;
/// Each front must also run along the link between the voxels.
constexpr float kAlongLink = 0.25F;
/// Of the harmonic solve: directions, not thickness, are read off it.
constexpr double kTolerance = 1e-6;
/// Steps a voxel of a trajectory.
constexpr double kStepsPerVoxel = 4;
/// A path is cut where, over so many of its steps, its distance to white matter grows at less than
/// this rate along it.  Along the floor where fronts meet head-on the rate is at most the sine of
/// half the angle by which they fall short of running straight against each other.
constexpr std::size_t kStallSteps = 2;
constexpr double kStallRate = 0.5;
/// Slope of the interpolant, per voxel, below which its direction is round-off.
constexpr float kFlat = 1e-6F;

/// Where a path is to be cut: how many of its points stay, all if it does not stall.
///
/// No part of a path gains more distance than it is long.  So what a part loses of it is no more
/// than what the whole does, and where the whole loses too little, nobody has to look at its parts.
template <class DistanceAt>
class StallSearch {
 public:
  StallSearch(const std::vector<float>& along, double step, const DistanceAt& distanceAt)
      : along_(along), distanceAt_(distanceAt), lostByStep_((1 - kStallRate) * step) {}

  [[nodiscard]] std::size_t run() const {
    constexpr std::size_t kFirst = 1;  // what is left of a shorter path is none
    const std::size_t last = along_.size() - 1;
    if (last < kFirst + kStallSteps) return along_.size();
    // The last step may be short: a stall that it is part of loses what the other steps do.
    if (along_[last] - distanceAt_(last) < (kStallSteps - 1) * lostByStep_) return along_.size();
    const std::size_t found = firstWithin(kFirst, last - 1);
    if (found < along_.size()) return found;
    return stallsTo(last) ? last - kStallSteps + 1 : along_.size();
  }

 private:
  [[nodiscard]] double lost(std::size_t from, std::size_t to) const {
    return along_[to] - along_[from] - (distanceAt_(to) - distanceAt_(from));
  }
  [[nodiscard]] bool stallsTo(std::size_t k) const {
    const double way = along_[k] - along_[k - kStallSteps];
    return distanceAt_(k) - distanceAt_(k - kStallSteps) < kStallRate * way;
  }
  /// The first stall between two points of the path.
  [[nodiscard]] std::size_t firstWithin(std::size_t from, std::size_t to) const {
    if (to < from + kStallSteps) return along_.size();
    constexpr double kRounding = 1e-3;  // of what a stall loses; arcs are float32 numbers
    if (lost(from, to) < (1 - kRounding) * kStallSteps * lostByStep_) return along_.size();
    if (to == from + kStallSteps) return stallsTo(to) ? from + 1 : along_.size();
    const std::size_t middle = (from + to + kStallSteps) / 2;
    const std::size_t found = firstWithin(from, middle);
    return found < along_.size() ? found : firstWithin(middle - kStallSteps + 1, to);
  }

  const std::vector<float>& along_;
  const DistanceAt& distanceAt_;
  double lostByStep_;  ///< by each whole step of a stall, at least, mm
};

}  // namespace

RibbonField::RibbonField(const CorticalTissue& tissue, const TriangleMesh& white,
                         const Monitor& monitor)
    : tissue_(tissue),
      white_(white),
      grid_(tissue.white.grid),
      step_(voxelSize(grid_) / kStepsPerVoxel) {
  monitor.progress(0.0, "buried sulci");
  const harmonic::Annulus open = ribbon();
  const std::vector<Bank> banks = banksOf(open);
  const std::vector<harmonic::Cut> cuts = betweenBanks(open, banks);
  cutLinks_ = static_cast<std::int64_t>(cuts.size());
  markMiddles(open, cuts);
  annulus_ = harmonic::withCuts(open, cuts);
  monitor.progress(0.4, "harmonic interpolant");
  harmonic::InterpolantOptions options;
  options.relativeTolerance = kTolerance;
  Monitor stoppable = monitor;
  stoppable.onProgress = nullptr;
  slope_ = harmonic::solveInterpolant(annulus_, options, stoppable).gradient;
  checkpoint(monitor);
  const float flat = kFlat / static_cast<float>(voxelSize(grid_));
  parallelFor(slope_.size(), 8192, [&](std::size_t n) {
    const float length = slope_[n].norm();
    slope_[n] = length > flat ? Eigen::Vector3f(slope_[n] / length) : Eigen::Vector3f::Zero();
  });
}

harmonic::Annulus RibbonField::ribbon() const {
  Volume<harmonic::Site> sites(grid_, harmonic::Site::Outer);
  Volume<float> innerLevel(grid_), outerLevel(grid_);
  parallelFor(sites.size(), 1 << 16, [&](std::size_t v) {
    innerLevel[v] = -tissue_.white[v];
    outerLevel[v] = -tissue_.tissue[v];
    if (tissue_.white[v] > 0) {
      sites[v] = harmonic::Site::Inner;
    } else if (tissue_.insulated[v]) {
      sites[v] = harmonic::Site::Insulated;
    } else if (tissue_.tissue[v] > 0) {
      sites[v] = harmonic::Site::Tissue;
    }
  });
  return harmonic::annulusFromSites(sites, innerLevel, outerLevel);
}

RibbonField::Bank RibbonField::bankAt(const Point& p, std::int32_t& near) const {
  Bank bank;
  const auto nearest = white_.closestPoint(p, near);
  near = nearest.face;
  bank.distance = static_cast<float>(std::sqrt(nearest.squaredDistance));
  const auto& mesh = white_.mesh();
  Vector normal = (mesh.corner(nearest.face, 1) - mesh.corner(nearest.face, 0))
                      .cross(mesh.corner(nearest.face, 2) - mesh.corner(nearest.face, 0));
  // The way from the bank is a better normal than the face's, once there is a way.
  if (bank.distance > 0.5 * step_ && normal.dot(p - nearest.point) > 0) normal = p - nearest.point;
  bank.normal = (grid_.direction.transpose() * normal.normalized()).cast<float>();
  return bank;
}

std::vector<RibbonField::Bank> RibbonField::banksOf(const harmonic::Annulus& ribbon) {
  std::vector<Bank> banks(ribbon.count());
  parallelForBlocks(banks.size(), 512, [&](std::size_t begin, std::size_t end) {
    std::int32_t near = 0;  // to the voxel before
    for (std::size_t n = begin; n < end; ++n) {
      banks[n] = bankAt(ribbon.world(static_cast<std::int32_t>(n)), near);
    }
  });
  // What leaves white matter at the least rate allowed is no longer than this where it is deepest.
  float deepest = 0;
  for (const Bank& bank : banks) deepest = std::max(deepest, bank.distance);
  longest_ = (deepest + grid_.spacing.maxCoeff()) / kStallRate;
  return banks;
}

std::vector<harmonic::Cut> RibbonField::betweenBanks(const harmonic::Annulus& ribbon,
                                                     const std::vector<Bank>& banks) const {
  std::vector<harmonic::Cut> cuts;
  for (std::size_t n = 0; n < banks.size(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::int32_t m = ribbon.links[n][2 * axis + 1];
      if (m < 0) continue;
      const Bank &here = banks[n], &there = banks[m];
      const float cn = here.normal[axis], cm = -there.normal[axis];
      if (here.normal.dot(there.normal) >= kHeadOn || cn <= kAlongLink || cm <= kAlongLink) {
        continue;
      }
      // Distances grow at the rate of the normals' share of the link: they are equal at
      //   dn + f h cn = dm + (1 - f) h cm.
      const auto h = static_cast<float>(grid_.spacing[axis]);
      const float f = (there.distance - here.distance + h * cm) / (h * (cn + cm));
      const float place = std::clamp(f, 0.05F, 0.95F);
      cuts.push_back({static_cast<std::int32_t>(n), axis, place, 1 - place});
    }
  }
  return cuts;
}

void RibbonField::markMiddles(const harmonic::Annulus& ribbon,
                              const std::vector<harmonic::Cut>& cuts) {
  const std::array<std::ptrdiff_t, 3> strides = {
      1, grid_.size[0], static_cast<std::ptrdiff_t>(grid_.size[0]) * grid_.size[1]};
  nearMiddle_.assign(grid_.voxelCount(), 0);
  // The voxels at both ends of a cut link, and their neighbours, must look out for the middle.
  for (const harmonic::Cut& cut : cuts) {
    const auto v = static_cast<std::ptrdiff_t>(ribbon.linear(cut.number));
    for (const std::ptrdiff_t end : {v, v + strides[cut.axis]}) {
      for (int k = -1; k <= 1; ++k) {
        for (int j = -1; j <= 1; ++j) {
          for (int i = -1; i <= 1; ++i) nearMiddle_[end + i + j * strides[1] + k * strides[2]] = 1;
        }
      }
    }
  }
}

Eigen::Vector3f RibbonField::slopeAt(int i, int j, int k) const {
  const std::array<int, 3> at = {i - annulus_.first[0], j - annulus_.first[1],
                                 k - annulus_.first[2]};
  for (int a = 0; a < 3; ++a) {
    if (at[a] < 0 || at[a] >= annulus_.size[a]) return Eigen::Vector3f::Zero();
  }
  const auto strides = annulus_.strides();
  const std::int32_t n = annulus_.numberAt[at[0] + at[1] * strides[1] + at[2] * strides[2]];
  return n < 0 ? Eigen::Vector3f(Eigen::Vector3f::Zero()) : slope_[n];
}

Vector RibbonField::direction(const Vector& index, const Vector& previous) const {
  // Corners whose slope runs against the way so far belong to another bank or to the other side of
  // a thin sheet of white matter: they have no say.
  std::array<int, 3> base;
  Vector t;
  for (int a = 0; a < 3; ++a) {
    base[a] = std::clamp(static_cast<int>(std::floor(index[a])), 1, grid_.size[a] - 3);
    t[a] = std::clamp(index[a] - base[a], 0.0, 1.0);
  }
  Vector sum = Vector::Zero();
  double weightSum = 0;
  for (int c = 0; c < 8; ++c) {
    const int i = c & 1, j = c >> 1 & 1, k = c >> 2;
    const Vector slope = slopeAt(base[0] + i, base[1] + j, base[2] + k).cast<double>();
    if (slope.dot(previous) <= 0) continue;
    const double weight = (i ? t[0] : 1 - t[0]) * (j ? t[1] : 1 - t[1]) * (k ? t[2] : 1 - t[2]);
    sum += weight * slope;
    weightSum += weight;
  }
  // Far from every corner that counts, the old direction goes on with the rest of the weight.
  sum += std::max(0.0, 0.25 - weightSum) * previous;
  const double length = sum.norm();
  return length > 1e-9 ? Vector(sum / length) : previous;
}

bool RibbonField::pastMiddle(const Point& p, const Vector& along, std::int32_t& near) const {
  const auto nearest = white_.closestPoint(p, near);
  near = nearest.face;
  return (p - nearest.point).dot(along) < -0.2 * std::sqrt(nearest.squaredDistance);
}

void RibbonField::cutWhereItStalls(Trajectory& path, std::int32_t near) const {
  const std::size_t count = path.points.size();
  std::vector<double> known(count, -1);
  const auto distanceAt = [&](std::size_t k) {
    if (known[k] < 0) {
      const auto nearest = white_.closestPoint(path.points[k], near);
      near = nearest.face;
      known[k] = std::sqrt(nearest.squaredDistance);
    }
    return known[k];
  };
  const std::size_t end = StallSearch(path.along, step_, distanceAt).run();
  if (end == count) return;
  path.points.resize(end);
  path.along.resize(end);
  path.end = TrajectoryEnd::Bank;
}

Trajectory RibbonField::trace(const Point& start, const Vector& normal, std::int32_t face) const {
  Trajectory path;
  path.points.push_back(start);
  path.along.push_back(0);
  const auto toAxes = [&](const Vector& world) -> Vector {
    return grid_.direction.transpose() * world;
  };
  const auto outside = [&](const Point& p) { return sample(tissue_.tissue, p).value <= 0; };
  const double gap = middleGap(grid_);
  const auto checked = [&](const Point& p) {
    const Vector index = grid_.toIndex(p);
    const int i = static_cast<int>(std::lround(index[0])),
              j = static_cast<int>(std::lround(index[1])),
              k = static_cast<int>(std::lround(index[2]));
    return grid_.contains(i, j, k) && nearMiddle_[grid_.linear(i, j, k)] != 0;
  };
  // Half a step out decides whether there is any ribbon here.
  if (outside(start + 0.5 * step_ * normal)) return path;

  Vector previous = toAxes(normal);
  double arc = 0;
  Point p = start;
  std::int32_t near = face;
  while (arc < longest_) {
    // Midpoint rule.
    const Vector first = direction(grid_.toIndex(p), previous);
    const Point half = p + 0.5 * step_ * grid_.axesToWorld(first);
    const Vector along = direction(grid_.toIndex(half), first);
    const Vector world = grid_.axesToWorld(along);
    Point next = p + step_ * world;
    const auto stops = [&](const Point& q) {
      if (outside(q)) return TrajectoryEnd::Outer;
      if (arc > step_ && checked(q) && pastMiddle(q + gap * world, world, near)) {
        return TrajectoryEnd::Bank;
      }
      return TrajectoryEnd::NoRibbon;
    };
    const TrajectoryEnd end = stops(next);
    if (end != TrajectoryEnd::NoRibbon) {
      double low = 0, high = step_;
      for (int halving = 0; halving < 6; ++halving) {
        const double middle = 0.5 * (low + high);
        (stops(p + middle * world) == TrajectoryEnd::NoRibbon ? low : high) = middle;
      }
      arc += low;
      path.points.push_back(p + low * world);
      path.along.push_back(static_cast<float>(arc));
      path.end = end;
      cutWhereItStalls(path, face);
      return path;
    }
    arc += step_;
    p = next;
    previous = along;
    path.points.push_back(p);
    path.along.push_back(static_cast<float>(arc));
  }
  path.end = TrajectoryEnd::Outer;
  cutWhereItStalls(path, face);
  return path;
}

}  // namespace explica::surface
