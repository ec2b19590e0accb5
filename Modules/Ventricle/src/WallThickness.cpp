// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Ventricle/WallThickness.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/OrderStatistics.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/StopScope.h"
#include "IntactSlices.h"
#include "Obliquity.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace explica::ventricle {

namespace {

constexpr Label kBeyondBase = 9;  // beside this module's labels: what lies beyond the valve plane

// Flatter than this the wall runs within the slice: the apical cap.
constexpr double kSteepestDeg = 60;

// A free end of the wall changes the harmonic function by exp(-pi d / t) at the distance d along a
// wall of thickness t: by 4 % at one thickness.
constexpr double kEndReach = 1;

double median(std::vector<double> values) {
  std::erase_if(values, [](double v) { return std::isnan(v); });
  return values.empty() ? kNaN : upperMedian(std::move(values));
}

/// Middle of two voxels, RAS mm.
Point between(const Grid& grid, std::size_t a, std::int64_t b) {
  const auto s = grid.subscripts(a), q = grid.subscripts(static_cast<std::size_t>(b));
  return grid.toWorld(0.5 * Vector(s[0] + q[0], s[1] + q[1], s[2] + q[2]));
}

/// Faces between the cavity and what is neither cavity nor wall nor insulated, RAS mm.
std::vector<Point> contactsOf(const Volume<Label>& heart) {
  std::vector<Point> contacts;
  for (std::size_t v = 0; v < heart.size(); ++v) {
    if (heart[v] != kCavity) continue;
    for (const std::int64_t next : heart.grid.neighbours(v)) {
      if (next < 0) continue;  // the edge of the field of view is insulated
      const Label other = heart[next];
      if (other == kCavity || other == kWall || other == kBeyondBase) continue;
      contacts.push_back(between(heart.grid, v, next));
    }
  }
  return contacts;
}

/// Marks what lies on the far side of the plane through the cavity's contacts on the basal half.
void insulateBeyondBase(Volume<Label>& heart, const LongAxis& axis) {
  std::vector<Point> contacts = contactsOf(heart);
  std::erase_if(contacts, [&](const Point& p) { return axis.share(p) > 0.5; });
  if (contacts.size() < 3) return;
  Point centre = Point::Zero();
  for (const Point& p : contacts) centre += p / static_cast<double>(contacts.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Point& p : contacts) spread += (p - centre) * (p - centre).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  Vector normal = solver.eigenvectors().col(0);
  if (normal.dot(axis.direction) > 0) normal = -normal;
  // A valve plane lies across the axis; contacts along the side of the cavity are gaps in the wall.
  if (std::abs(normal.dot(axis.direction)) < 0.5) return;
  const double tolerance = 0.5 * heart.grid.spacing.maxCoeff();
  parallelFor(heart.size(), 1 << 14, [&](std::size_t v) {
    if (heart[v] == kCavity || heart[v] == kWall) return;
    if ((centreOf(heart.grid, v) - centre).dot(normal) > -tolerance) heart[v] = kBeyondBase;
  });
}

bool has(const Volume<Label>& heart, Label label) {
  return std::find(heart.data.begin(), heart.data.end(), label) != heart.data.end();
}

/// Solves on the tissue and keeps the lengths.
void solve(WallThickness& wall, const Volume<Label>& heart, const Monitor& monitor) {
  harmonic::LabelRoles roles{{kCavity}, {kWall}, {}, {}};
  if (has(heart, kBeyondBase)) roles.insulated = {kBeyondBase};
  Monitor silent = monitor;
  silent.onWarning = nullptr;  // gaps are this module's subject: it finds and tells them itself
  static_cast<correspondence::Ribbon&>(wall) = correspondence::solveRibbon(
      harmonic::annulusFromLabels(heart, roles, {.perSlice = wall.bySlice}, silent), std::nullopt,
      {}, silent);
  wall.correspondence =
      correspondence::findCorrespondences(wall.annulus, wall.interpolant, {}, silent);
  checkpoint(monitor);  // half a solution is no wall
  wall.plain = correspondence::thicknessOf(wall.correspondence);
  wall.thickness = wall.plain;
  wall.leftOut.assign(wall.plain.size(), LeftOut::None);
}

/// Place of a world offset from voxel n in mm along i and j.
Eigen::Vector2d inSlice(const harmonic::Annulus& annulus, std::int32_t n,
                        const Eigen::Vector3f& offset) {
  const Grid& grid = annulus.grid;
  const Vector at = grid.spacing.cwiseProduct(annulus.index(n)) +
                    grid.direction.transpose() * offset.cast<double>();
  return at.head<2>();
}

/// In thick slices the base is the plane across the axis at the cavity's end: what lies beyond it
/// in slices that it may cut is insulated.
void insulateAtBase(Volume<Label>& heart, const std::vector<bool>& cut, const LongAxis& axis) {
  parallelFor(heart.size(), 1 << 14, [&](std::size_t v) {
    if (heart[v] == kCavity || heart[v] == kWall) return;
    const auto s = heart.grid.subscripts(v);
    if (!cut[static_cast<std::size_t>(s[2])]) return;
    if (atBase(centreOf(heart.grid, v), heart.grid, axis)) heart[v] = kBeyondBase;
  });
}

/// Replaces lengths within the slice by the sum of the distances to the boundaries in the plane
/// through the trajectory's ends and the slice's normal.
void correctObliquity(WallThickness& wall, const Volume<Label>& heart, const LongAxis& axis,
                      const SliceAlignment& alignment) {
  const std::vector<bool> intact = intactSlices(wall.slices, heart, axis);
  std::vector<bool> inner, outer;
  int rings = 0;
  for (std::size_t k = 0; k < wall.slices.size(); ++k) {
    const SliceKind kind = wall.slices[k].kind;
    const bool ring = intact[k] && kind == SliceKind::Ring;
    rings += ring;
    inner.push_back(ring || (intact[k] && kind == SliceKind::CavityOnly));
    outer.push_back(ring || (intact[k] && kind == SliceKind::Cap));
  }
  if (rings < 2) {  // what there is must do
    for (std::size_t k = 0; k < wall.slices.size(); ++k) {
      inner[k] = inner[k] || wall.slices[k].whole();
      outer[k] = outer[k] || wall.slices[k].whole();
    }
  }
  const BoundaryProfile innerProfile(heart, inner, alignment.shift,
                                     [](Label l) { return l == kCavity; });
  const BoundaryProfile outerProfile(heart, outer, alignment.shift,
                                     [](Label l) { return l == kCavity || l == kWall; });
  parallelFor(wall.plain.size(), 256, [&](std::size_t n) {
    const auto number = static_cast<std::int32_t>(n);
    if (std::isnan(wall.plain[n])) return;
    const int k = static_cast<int>(wall.annulus.index(number)[2]);
    const Eigen::Vector2d from = inSlice(wall.annulus, number, wall.correspondence.innerPoint[n]);
    const Eigen::Vector2d to = inSlice(wall.annulus, number, wall.correspondence.outerPoint[n]);
    const Eigen::Vector2d normal = (to - from).normalized(), shift = alignment.shift[k];
    const double length =
        innerProfile.distance(k, from - shift, normal, -wall.correspondence.innerDistance[n]) +
        outerProfile.distance(k, to - shift, normal, wall.correspondence.outerDistance[n]);
    wall.thickness[n] = length;
    if (length < std::cos(kSteepestDeg * kPi / 180) * wall.plain[n]) wall.leftOut[n] = LeftOut::Cap;
  });
}

/// Trajectories that come to the base.
void leaveOutAtBase(WallThickness& wall, const LongAxis& axis) {
  const Grid& grid = wall.annulus.grid;
  const std::vector<bool> cut = cutSlices(wall.slices, grid, axis);
  parallelFor(wall.plain.size(), 256, [&](std::size_t n) {
    const auto number = static_cast<std::int32_t>(n);
    if (!cut[static_cast<std::size_t>(wall.annulus.index(number)[2])]) return;
    const Point x = wall.annulus.world(number);
    const Point inner = x + wall.correspondence.innerPoint[n].cast<double>();
    const Point outer = x + wall.correspondence.outerPoint[n].cast<double>();
    if (atBase(x, grid, axis) || atBase(inner, grid, axis) || atBase(outer, grid, axis)) {
      wall.leftOut[n] = LeftOut::Valve;
    }
  });
}

/// Voxels within a wall's thickness of places where the cavity touches the outside.
void leaveOutNear(WallThickness& wall, const std::vector<std::vector<Point>>& contacts,
                  const std::vector<double>& reach) {
  parallelFor(wall.plain.size(), 256, [&](std::size_t n) {
    const auto number = static_cast<std::int32_t>(n);
    const std::size_t k =
        wall.bySlice ? static_cast<std::size_t>(wall.annulus.index(number)[2]) : 0;
    if (contacts[k].empty() || std::isnan(reach[k])) return;
    const Point x = wall.annulus.world(number);
    const Point inner = x + wall.correspondence.innerPoint[n].cast<double>();
    for (const Point& c : contacts[k]) {
      if (std::min((x - c).squaredNorm(), (inner - c).squaredNorm()) > reach[k] * reach[k])
        continue;
      wall.leftOut[n] = LeftOut::Opening;
      return;
    }
  });
}

/// Where the ring of each slice ends: the cavity's contacts with the outside, and the wall's faces
/// at the base.  RAS mm.
std::vector<std::vector<Point>> ringEnds(const WallThickness& wall, const Volume<Label>& marked) {
  const Grid& grid = marked.grid;
  std::vector<std::vector<Point>> ends(wall.slices.size());
  for (std::size_t k = 0; k < wall.slices.size(); ++k) {
    for (const Eigen::Vector2d& c : wall.slices[k].contacts) {
      const Eigen::Vector2d at = c.cwiseQuotient(grid.spacing.head<2>());
      ends[k].push_back(grid.toWorld(Vector(at[0], at[1], static_cast<double>(k))));
    }
  }
  for (std::size_t v = 0; v < marked.size(); ++v) {
    if (marked[v] != kWall) continue;
    const auto k = static_cast<std::size_t>(grid.subscripts(v)[2]);
    const auto near = grid.neighbours(v);
    for (int d = 0; d < 4; ++d) {
      if (near[d] >= 0 && marked[near[d]] == kBeyondBase) {
        ends[k].push_back(between(grid, v, near[d]));
      }
    }
  }
  return ends;
}

/// Near the ends of rings, and all of a slice that is open where the base cuts it.
void leaveOutBySlice(WallThickness& wall, const Volume<Label>& marked,
                     const std::vector<bool>& intact) {
  std::vector<std::vector<double>> lengths(wall.slices.size());
  for (std::size_t n = 0; n < wall.plain.size(); ++n) {
    const auto k = static_cast<std::size_t>(wall.annulus.index(static_cast<std::int32_t>(n))[2]);
    lengths[k].push_back(wall.plain[n]);
  }
  std::vector<double> reach;
  for (const std::vector<double>& values : lengths) reach.push_back(kEndReach * median(values));
  leaveOutNear(wall, ringEnds(wall, marked), reach);
  for (std::size_t n = 0; n < wall.plain.size(); ++n) {
    const auto k = static_cast<std::size_t>(wall.annulus.index(static_cast<std::int32_t>(n))[2]);
    const SliceKind kind = wall.slices[k].kind;
    if (kind == SliceKind::Valve || (kind == SliceKind::OpenRing && !intact[k])) {
      wall.leftOut[n] = LeftOut::Valve;
    }
  }
}

void markUnreached(WallThickness& wall) {
  for (std::size_t n = 0; n < wall.plain.size(); ++n) {
    if (std::isnan(wall.plain[n])) wall.leftOut[n] = LeftOut::Unreached;
  }
}

/// What has become of every voxel of the wall, those included that the solve did not take.
Volume<std::uint8_t> reasonsOf(const WallThickness& wall, const Volume<Label>& heart,
                               const LongAxis& axis) {
  Volume<std::uint8_t> reasons(heart.grid, 255);
  const std::size_t pixels = static_cast<std::size_t>(heart.grid.size[0]) * heart.grid.size[1];
  for (std::size_t v = 0; v < heart.size(); ++v) {
    if (heart[v] != kWall) continue;
    const SliceKind kind = wall.slices[v / pixels].kind;
    LeftOut why = LeftOut::Unreached;
    if (wall.bySlice && kind == SliceKind::Cap) {
      // Wall without cavity is the apex, or what an oblique base leaves of a ring.
      why = axis.share(centreOf(heart.grid, v)) > 0.5 ? LeftOut::Cap : LeftOut::Valve;
    }
    if (wall.bySlice && kind == SliceKind::Valve) why = LeftOut::Valve;
    reasons[v] = static_cast<std::uint8_t>(why);
  }
  for (std::size_t n = 0; n < wall.leftOut.size(); ++n) {
    reasons[wall.annulus.linear(static_cast<std::int32_t>(n))] =
        static_cast<std::uint8_t>(wall.leftOut[n]);
  }
  return reasons;
}

}  // namespace

WallThickness measureWall(const Volume<Label>& heart, const LongAxis& axis,
                          const SliceAlignment& alignment, const WallOptions& options,
                          const Monitor& monitor) {
  if (!has(heart, kWall)) throw InvalidInput("the frame has no wall");
  WallThickness wall;
  wall.slices = slicesOf(heart);
  wall.bySlice = options.method == WallMethod::Slices ||
                 (options.method == WallMethod::Automatic && hasThickSlices(heart.grid));
  Volume<Label> marked = heart;
  if (wall.bySlice) {
    insulateAtBase(marked, cutSlices(wall.slices, heart.grid, axis), axis);
    solve(wall, marked, monitor);
    correctObliquity(wall, heart, axis, alignment);
    leaveOutBySlice(wall, marked, intactSlices(wall.slices, heart, axis));
    leaveOutAtBase(wall, axis);
  } else {
    insulateBeyondBase(marked, axis);
    solve(wall, marked, monitor);
    leaveOutNear(wall, {contactsOf(marked)}, {kEndReach * median(wall.plain)});
  }
  markUnreached(wall);
  wall.reasons = reasonsOf(wall, heart, axis);
  return wall;
}

void ColumnMean::add(double thickness, double plain) {
  if (!(thickness > 0)) return;
  ++count_;
  columns_ += 1 / thickness;
  sum_ += thickness;
  plainColumns_ += 1 / plain;
  lowest_ = std::min(lowest_, thickness);
  highest_ = std::max(highest_, thickness);
}

double ColumnMean::mean() const {
  return count_ > 0 ? static_cast<double>(count_) / columns_ : kNaN;
}

double ColumnMean::plain() const {
  return count_ > 0 ? static_cast<double>(count_) / plainColumns_ : kNaN;
}

double ColumnMean::deviation() const {
  // With weights 1 / t the mean square is sum(t) / sum(1 / t).
  return count_ > 0 ? std::sqrt(std::max(0.0, sum_ / columns_ - mean() * mean())) : kNaN;
}

}  // namespace explica::ventricle
