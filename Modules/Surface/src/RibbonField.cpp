// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "RibbonField.h"

#include "Explica/Core/Parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::surface {
namespace {

/// Fronts meet head-on if the angle between their normals is more than this (cosine).
constexpr float kHeadOn = -0.5F;
/// Each front must also run along the link between the voxels.
constexpr float kAlongLink = 0.25F;
/// The surface keeps this share of a voxel from the middle between two banks.
constexpr double kMiddleGap = 0.1;
/// Steps a voxel of a trajectory.
constexpr double kStepsPerVoxel = 4;
/// A path is looked at again if it is longer than this many times its end's distance to white
/// matter and this many mm; it is cut where that distance grows at less than this rate along it.
constexpr double kStallRatio = 1.3;
constexpr double kStallSlack = 0.25;
constexpr double kStallRate = 0.3;
/// No cortex is thicker, mm; a longer trajectory has lost its way and is ended there.
constexpr double kLongest = 12;

}  // namespace

Point Trajectory::at(double arc) const {
  if (points.size() == 1 || arc <= 0) return points.front();
  const auto next = std::upper_bound(along.begin(), along.end(), static_cast<float>(arc));
  if (next == along.end()) return points.back();
  const std::size_t k = next - along.begin();
  const double span = along[k] - along[k - 1];
  const double t = span > 0 ? (arc - along[k - 1]) / span : 0;
  return points[k - 1] + t * (points[k] - points[k - 1]);
}

RibbonField::RibbonField(const CorticalTissue& tissue, const TriangleMesh& white,
                         const Monitor& monitor)
    : tissue_(tissue),
      white_(white),
      grid_(tissue.white.grid),
      step_(grid_.spacing.minCoeff() / kStepsPerVoxel) {
  nodeAt_.assign(grid_.voxelCount(), -1);
  for (const int parity : {0, 1}) {
    for (std::size_t v = 0; v < grid_.voxelCount(); ++v) {
      const auto at = grid_.subscripts(v);
      if (((at[0] + at[1] + at[2]) & 1) != parity) continue;
      if (tissue.white[v] > 0 || tissue.tissue[v] <= 0 || tissue.insulated[v]) continue;
      nodeAt_[v] = static_cast<std::int32_t>(voxelOf_.size());
      voxelOf_.push_back(static_cast<std::uint32_t>(v));
    }
    if (parity == 0) evenCount_ = voxelOf_.size();
  }
  monitor.progress(0.0, "buried sulci");
  findBanks();
  buildNodes();
  monitor.progress(0.4, "harmonic interpolant");
  solve();
  differentiate();
}

void RibbonField::findBanks() {
  bankNormal_.resize(voxelOf_.size());
  bankDistance_.resize(voxelOf_.size());
  parallelFor(voxelOf_.size(), 512, [&](std::size_t n) {
    const auto at = grid_.subscripts(voxelOf_[n]);
    const Point p = grid_.toWorld(Vector(at[0], at[1], at[2]));
    const auto nearest = white_.closestPoint(p);
    bankDistance_[n] = static_cast<float>(std::sqrt(nearest.squaredDistance));
    const auto& mesh = white_.mesh();
    Vector normal = (mesh.corner(nearest.face, 1) - mesh.corner(nearest.face, 0))
                        .cross(mesh.corner(nearest.face, 2) - mesh.corner(nearest.face, 0));
    // The way from the bank is a better normal than the face's, once there is a way.
    if (bankDistance_[n] > 0.5 * step_ && normal.dot(p - nearest.point) > 0) {
      normal = p - nearest.point;
    }
    bankNormal_[n] = (grid_.direction.transpose() * normal.normalized()).cast<float>();
  });
}

void RibbonField::buildNodes() {
  nodes_.resize(voxelOf_.size());
  nearMiddle_.assign(grid_.voxelCount(), 0);
  const std::array<std::ptrdiff_t, 3> strides = {
      1, grid_.size[0], static_cast<std::ptrdiff_t>(grid_.size[0]) * grid_.size[1]};
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const std::size_t v = voxelOf_[n];
    Node& node = nodes_[n];
    for (int d = 0; d < 6; ++d) {
      const int axis = d / 2;
      const std::ptrdiff_t w = static_cast<std::ptrdiff_t>(v) + (d % 2 ? 1 : -1) * strides[axis];
      const float h = static_cast<float>(grid_.spacing[axis]);
      node.neighbour[d] = -1;
      node.value[d] = 0;
      node.reach[d] = h;
      if (nodeAt_[w] >= 0) {
        const std::int32_t m = nodeAt_[w];
        const float sign = d % 2 ? 1.0F : -1.0F;
        const bool meet = bankNormal_[n].dot(bankNormal_[m]) < kHeadOn &&
                          sign * bankNormal_[n][axis] > kAlongLink &&
                          sign * bankNormal_[m][axis] < -kAlongLink;
        if (!meet) {
          node.neighbour[d] = m;
          continue;
        }
        // Distances grow at the rate of the normals' share of the link: they are equal at
        //   dn + f h cn = dm + (1 - f) h cm.
        const float cn = sign * bankNormal_[n][axis], cm = -sign * bankNormal_[m][axis];
        const float f = (bankDistance_[m] - bankDistance_[n] + h * cm) / (h * (cn + cm));
        node.value[d] = 1;
        node.reach[d] = h * std::clamp(f, 0.05F, 0.95F);
        nearMiddle_[v] = 1;
        if (d % 2) ++cutLinks_;
      } else if (tissue_.white[w] > 0) {
        const float a = -tissue_.white[v], b = tissue_.white[w];
        node.reach[d] = h * std::clamp(a / (a + b), 0.05F, 1.0F);
      } else if (tissue_.insulated[w]) {
        node.reach[d] = 0;
      } else {
        const float a = tissue_.tissue[v], b = -tissue_.tissue[w];
        node.value[d] = 1;
        node.reach[d] = h * std::clamp(a / (a + b), 0.05F, 1.0F);
      }
    }
  }
  // A voxel's own neighbours must look out for the middle, too.
  std::vector<std::uint8_t> wide = nearMiddle_;
  for (std::size_t n = 0; n < nodes_.size(); ++n) {
    const std::size_t v = voxelOf_[n];
    if (!nearMiddle_[v]) continue;
    for (int k = -1; k <= 1; ++k) {
      for (int j = -1; j <= 1; ++j) {
        for (int i = -1; i <= 1; ++i) wide[v + i + j * strides[1] + k * strides[2]] = 1;
      }
    }
  }
  nearMiddle_ = std::move(wide);
}

void RibbonField::solve() {
  // Shortley-Weller stencil with over-relaxation, even and odd voxels in turn.  The ribbon is a few
  // voxels thick, so that a small number of sweeps is enough.
  constexpr float kRelaxation = 1.5F;
  constexpr int kMostSweeps = 400;
  constexpr double kStill = 1e-5;
  constexpr std::size_t kGrain = 8192;
  struct Stencil {
    std::array<float, 6> weight;
    float constant;
  };
  std::vector<Stencil> stencils(nodes_.size());
  parallelFor(nodes_.size(), kGrain, [&](std::size_t n) {
    const Node& node = nodes_[n];
    Stencil& s = stencils[n];
    float sum = 0;
    s.constant = 0;
    for (int d = 0; d < 6; ++d) {
      const float h = static_cast<float>(grid_.spacing[d / 2]);
      const float other = node.reach[d ^ 1] > 0 ? node.reach[d ^ 1] : h;
      s.weight[d] = node.reach[d] > 0 ? 2 / (node.reach[d] * (node.reach[d] + other)) : 0;
      sum += s.weight[d];
    }
    if (sum == 0) return;
    for (int d = 0; d < 6; ++d) {
      s.weight[d] /= sum;
      if (node.neighbour[d] < 0) {
        s.constant += s.weight[d] * node.value[d];
        s.weight[d] = 0;
      }
    }
  });
  u_.assign(nodes_.size(), 0.5F);
  struct Largest {
    double value = 0;
    Largest& operator+=(const Largest& other) {
      value = std::max(value, other.value);
      return *this;
    }
  };
  for (iterations_ = 0; iterations_ < kMostSweeps;) {
    Largest change;
    for (const int parity : {0, 1}) {
      const std::size_t first = parity ? evenCount_ : 0;
      const std::size_t count = parity ? nodes_.size() - evenCount_ : evenCount_;
      change += parallelSum(count, kGrain, Largest{}, [&](std::size_t begin, std::size_t end) {
        Largest mine;
        for (std::size_t n = first + begin; n < first + end; ++n) {
          const Stencil& s = stencils[n];
          float next = s.constant;
          for (int d = 0; d < 6; ++d) {
            if (nodes_[n].neighbour[d] >= 0) next += s.weight[d] * u_[nodes_[n].neighbour[d]];
          }
          const float step = kRelaxation * (next - u_[n]);
          u_[n] += step;
          mine.value = std::max(mine.value, static_cast<double>(std::abs(step)));
        }
        return mine;
      });
    }
    ++iterations_;
    lastChange_ = change.value;
    if (lastChange_ < kStill) break;
  }
}

void RibbonField::differentiate() {
  slope_.resize(nodes_.size());
  parallelFor(nodes_.size(), 8192, [&](std::size_t n) {
    const Node& node = nodes_[n];
    Eigen::Vector3f g;
    for (int axis = 0; axis < 3; ++axis) {
      float value[2], reach[2];
      for (int side = 0; side < 2; ++side) {
        const int d = 2 * axis + side;
        reach[side] = node.reach[d] > 0 ? node.reach[d] : static_cast<float>(grid_.spacing[axis]);
        value[side] = node.neighbour[d] >= 0 ? u_[node.neighbour[d]]
                      : node.reach[d] > 0    ? node.value[d]
                                             : u_[n];
      }
      const float below = reach[0], above = reach[1];
      g[axis] = (below * below * (value[1] - u_[n]) + above * above * (u_[n] - value[0])) /
                (below * above * (below + above));
    }
    const float length = g.norm();
    slope_[n] = length > 1e-6F ? Eigen::Vector3f(g / length) : Eigen::Vector3f::Zero();
  });
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
    const std::int32_t n = nodeAt_[grid_.linear(base[0] + i, base[1] + j, base[2] + k)];
    if (n < 0) continue;
    const Vector slope = slope_[n].cast<double>();
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

bool RibbonField::pastMiddle(const Point& p, const Vector& along) const {
  const auto nearest = white_.closestPoint(p);
  return (p - nearest.point).dot(along) < -0.2 * std::sqrt(nearest.squaredDistance);
}

void RibbonField::cutWhereItStalls(Trajectory& path) const {
  const auto distanceAt = [&](const Point& p) {
    return std::sqrt(white_.closestPoint(p).squaredDistance);
  };
  if (path.length() < kStallRatio * distanceAt(path.points.back()) + kStallSlack) return;
  constexpr std::size_t kWindow = 3;
  std::vector<double> distance;
  for (std::size_t k = 0; k < path.points.size(); ++k) {
    distance.push_back(distanceAt(path.points[k]));
    if (k < kWindow + 1) continue;
    const double way = path.along[k] - path.along[k - kWindow];
    if (distance[k] - distance[k - kWindow] >= kStallRate * way) continue;
    path.points.resize(k - kWindow + 1);
    path.along.resize(k - kWindow + 1);
    path.end = TrajectoryEnd::Bank;
    return;
  }
}

Trajectory RibbonField::trace(const Point& start, const Vector& normal) const {
  Trajectory path;
  path.points.push_back(start);
  path.along.push_back(0);
  const auto toAxes = [&](const Vector& world) -> Vector {
    return grid_.direction.transpose() * world;
  };
  const auto outside = [&](const Point& p) { return sample(tissue_.tissue, p).value <= 0; };
  const double gap = kMiddleGap * grid_.spacing.minCoeff();
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
  while (arc < kLongest) {
    // Midpoint rule.
    const Vector first = direction(grid_.toIndex(p), previous);
    const Point half = p + 0.5 * step_ * grid_.axesToWorld(first);
    const Vector along = direction(grid_.toIndex(half), first);
    const Vector world = grid_.axesToWorld(along);
    Point next = p + step_ * world;
    const auto stops = [&](const Point& q) {
      if (outside(q)) return TrajectoryEnd::Outer;
      if (arc > step_ && checked(q) && pastMiddle(q + gap * world, world)) {
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
      cutWhereItStalls(path);
      return path;
    }
    arc += step_;
    p = next;
    previous = along;
    path.points.push_back(p);
    path.along.push_back(static_cast<float>(arc));
  }
  path.end = TrajectoryEnd::Outer;
  cutWhereItStalls(path);
  return path;
}

}  // namespace explica::surface
