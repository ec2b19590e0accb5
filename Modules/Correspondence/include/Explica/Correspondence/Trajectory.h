// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Harmonic/Annulus.h"
#include "Explica/Harmonic/Interpolant.h"

#include <memory>
#include <optional>
#include <vector>

namespace explica::correspondence {

/// How carefully trajectories are followed.
struct TraceOptions {
  double tolerance = 4e-3;  ///< greatest error estimate of a step, in voxels
  double maxStep = 1;  ///< longest step, in voxels of the finest spacing; beyond one it is half
                       ///< of what is left at most, and half a voxel where two banks share a
                       ///< cell, so that the bank stays known
};

/// Where a trajectory came to.
struct Trace {
  Point point = Point::Constant(kNaN);  ///< RAS mm
  double length = kNaN;                 ///< mm along the trajectory, >= 0
  double u = kNaN;                      ///< there
  bool reached = false;                 ///< false: left the tissue or stagnated; the rest is where
};

/// A trajectory as a polyline.
struct Path {
  std::vector<Point> points;  ///< RAS mm, start first
  std::vector<float> along;   ///< arc length at each point, mm

  [[nodiscard]] double length() const { return along.empty() ? 0 : along.back(); }
  /// Point at an arc length, held to the ends.
  [[nodiscard]] Point at(double arc) const;
};

/// Follows trajectories of T = grad u / |grad u| through the tissue [thesis 3.1, Lagrangian].
///
/// T is the trilinear interpolant of the voxels' gradients, and u that of their first-order Taylor
/// expansions, which is exact for quadratic u.  Next to a boundary, values beyond it are extended
/// from the trajectory's own side, so that neither the other bank of a sulcus nor the jump at the
/// boundary enters.  Steps are those of the embedded Runge-Kutta pair 3(2) [BogackiShampine1989].
///
/// Keeps references to the annulus and the interpolant; both must outlive it.  Safe to use from
/// several threads.
class TrajectoryTracer {
 public:
  TrajectoryTracer(const harmonic::Annulus& annulus, const harmonic::Interpolant& interpolant,
                   const TraceOptions& options = {});
  ~TrajectoryTracer();
  TrajectoryTracer(TrajectoryTracer&&) noexcept;

  /// From a world point in or within two voxels of the tissue to the level u = target: 0 inner
  /// boundary, 1 outer boundary, or between.  Goes up or down as needed.  A start beyond the level
  /// comes back to it, its length counted positive.
  [[nodiscard]] Trace trace(const Point& start, double target) const;

  /// The same with a point for each step; nothing if it does not get there.
  [[nodiscard]] std::optional<Path> path(const Point& start, double target) const;

  /// From a tissue voxel's centre.
  [[nodiscard]] Trace trace(std::int32_t number, double target) const;

  /// Length of the trajectory through a point between the two boundaries, mm; nothing if it does
  /// not reach both.
  [[nodiscard]] std::optional<double> thickness(const Point& point) const;

  /// Interpolated u, extended past the boundary; nothing if no tissue is within two voxels.
  [[nodiscard]] std::optional<double> value(const Point& point) const;

  /// Unit direction T at a point, RAS; nothing if no tissue is within two voxels.
  [[nodiscard]] std::optional<Vector> direction(const Point& point) const;

  [[nodiscard]] const harmonic::Annulus& annulus() const;

  struct Field;
  [[nodiscard]] const Field& field() const { return *field_; }

 private:
  std::unique_ptr<Field> field_;
};

}  // namespace explica::correspondence
