// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Geometry/FaceTree.h"
#include "Explica/Surface/CorticalTissue.h"

#include <array>
#include <cstdint>
#include <vector>

namespace explica::surface {

/// What ended a trajectory.
enum class TrajectoryEnd : std::uint8_t {
  Outer,    ///< the outer boundary
  Bank,     ///< the middle between the banks of a buried sulcus
  NoRibbon  ///< there is no tissue at the start
};

/// From a point of the white surface along the gradient of the harmonic interpolant.
struct Trajectory {
  std::vector<Point> points;  ///< start first; one point only if there is no ribbon
  std::vector<float> along;   ///< arc length at each point, mm
  TrajectoryEnd end = TrajectoryEnd::NoRibbon;

  [[nodiscard]] double length() const { return along.empty() ? 0 : along.back(); }
  /// Point at an arc length, held to the ends.
  [[nodiscard]] Point at(double arc) const;
};

/// The harmonic interpolant of the ribbon, with the hidden outer boundary of buried sulci.
///
/// Where fronts from two banks of white matter meet head-on between neighbouring grey voxels, the
/// link between them is cut at the place of equal distance, and u = 1 there: as in anatomically
/// consistent enhancement [Han2004], but without giving up the voxels.
class RibbonField {
 public:
  /// @param white  surface of the white matter, closed, outward
  RibbonField(const CorticalTissue& tissue, const TriangleMesh& white, const Monitor& monitor);

  /// Trajectory from a point of the white surface with outward normal `normal`.
  [[nodiscard]] Trajectory trace(const Point& start, const Vector& normal) const;

  [[nodiscard]] std::int64_t cutLinks() const { return cutLinks_; }
  [[nodiscard]] int iterations() const { return iterations_; }
  [[nodiscard]] double lastChange() const { return lastChange_; }

 private:
  struct Node {
    std::array<std::int32_t, 6> neighbour;  ///< node, or -1
    std::array<float, 6> value;             ///< u beyond a link that ends at a boundary
    std::array<float, 6> reach;             ///< length of the link, mm; 0 if insulated
  };

  void findBanks();
  void buildNodes();
  void solve();
  void differentiate();
  [[nodiscard]] Vector direction(const Vector& index, const Vector& previous) const;
  /// True if the nearest white matter lies ahead: the middle between two banks was passed.
  [[nodiscard]] bool pastMiddle(const Point& p, const Vector& direction) const;
  /// Ends a path where it no longer leaves white matter behind: from there it only follows the
  /// floor between two banks.
  void cutWhereItStalls(Trajectory& path) const;

  const CorticalTissue& tissue_;
  geometry::FaceTree white_;
  const Grid& grid_;
  double step_;
  std::vector<std::int32_t> nodeAt_;    ///< per voxel; -1 off the ribbon
  std::vector<std::uint32_t> voxelOf_;  ///< per node, even ones first
  std::size_t evenCount_ = 0;
  std::vector<Node> nodes_;
  std::vector<float> u_;
  std::vector<Eigen::Vector3f> slope_;       ///< per node: unit vector, along the axes
  std::vector<std::uint8_t> nearMiddle_;     ///< per voxel
  std::vector<Eigen::Vector3f> bankNormal_;  ///< per node: of the nearest white surface
  std::vector<float> bankDistance_;          ///< per node, mm
  std::int64_t cutLinks_ = 0;
  int iterations_ = 0;
  double lastChange_ = 0;
};

}  // namespace explica::surface
