// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"
#include "Explica/Correspondence/Ribbon.h"
#include "Explica/Correspondence/Trajectory.h"

#include <cstdint>
#include <vector>

namespace explica::surface {

/// So far outward of white matter tissue begins, or there is none, voxels.
inline constexpr double kStartOff = 0.125;

/// What ended a trajectory.
enum class TrajectoryEnd : std::uint8_t {
  Outer,    ///< the outer boundary
  Bank,     ///< the middle between the banks of a buried sulcus
  Astray,   ///< where those around end, inside of the boundary
  NoRibbon  ///< there is no tissue at the start
};

/// From a point of a surface to a boundary of the ribbon; the start alone if there is no ribbon.
struct Trajectory : correspondence::Path {
  TrajectoryEnd end = TrajectoryEnd::NoRibbon;
};

/// What surfaces keep from the middle between two banks, mm: trajectories of both end there, in one
/// and the same place.
[[nodiscard]] double middleGap(const Grid& grid);

/// The trajectories of a ribbon, as surfaces grow along them.  Keeps a reference to the ribbon.
class RibbonPaths {
 public:
  explicit RibbonPaths(const correspondence::Ribbon& ribbon);

  [[nodiscard]] const correspondence::TrajectoryTracer& tracer() const { return tracer_; }

  /// @param target  0: to the inner boundary; 1: to the outer one
  [[nodiscard]] Trajectory from(const Point& start, double target) const;

  /// Where there is no ribbon.
  [[nodiscard]] static Trajectory none(const Point& start);

  /// To the outer boundary from a point of the inner one with outward normal `normal`.
  [[nodiscard]] Trajectory outwardFrom(const Point& start, const Vector& normal) const;

  /// Whether the voxel around a point is tissue.
  [[nodiscard]] bool isTissue(const Point& point) const;

  /// True if the middle of a buried sulcus passes beside a corner of the point's cell.
  [[nodiscard]] bool isBank(const Point& point) const;

 private:
  const harmonic::Annulus& annulus_;
  correspondence::TrajectoryTracer tracer_;
  std::vector<std::uint8_t> isSulcal_;  ///< per tissue voxel
};

/// Ends a trajectory at an arc length.
void cut(Trajectory& path, double end);

/// Ends trajectories that lead to the middle between two banks a little before it.
void keepFromMiddles(double gap, std::vector<Trajectory>& paths);

}  // namespace explica::surface
