// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Geometry/FaceTree.h"
#include "Explica/Harmonic/Annulus.h"
#include "Explica/Surface/CorticalTissue.h"
#include "RibbonPaths.h"

#include <cstdint>
#include <vector>

namespace explica::surface {

/// The harmonic interpolant of the ribbon, with the hidden outer boundary of buried sulci: for
/// surfaces whose borders an image places.
///
/// Where fronts from two banks of white matter meet head-on between neighbouring grey voxels, the
/// link between them is cut at the place of equal distance, and u = 1 there: as in anatomically
/// consistent enhancement [Han2004], but without giving up the voxels.
class RibbonField {
 public:
  /// @param white  surface of the white matter, closed, outward
  RibbonField(const CorticalTissue& tissue, const TriangleMesh& white, const Monitor& monitor);

  /// Trajectory from a point of the white surface with outward normal `normal`.
  /// @param face  of the white surface, at the point: only the time depends on it
  [[nodiscard]] Trajectory trace(const Point& start, const Vector& normal, std::int32_t face) const;

  [[nodiscard]] std::int64_t cutLinks() const { return cutLinks_; }

 private:
  /// The white matter nearest to a tissue voxel.
  struct Bank {
    Eigen::Vector3f normal;  ///< of its surface, along the axes
    float distance;          ///< to it, mm
  };
  [[nodiscard]] harmonic::Annulus ribbon() const;
  /// @param near  a face of the white surface to look at first; then the nearest one
  [[nodiscard]] Bank bankAt(const Point& p, std::int32_t& near) const;
  [[nodiscard]] std::vector<Bank> banksOf(const harmonic::Annulus& ribbon);
  /// Links between voxels where fronts from two banks meet head-on.
  [[nodiscard]] std::vector<harmonic::Cut> betweenBanks(const harmonic::Annulus& ribbon,
                                                        const std::vector<Bank>& banks) const;
  void markMiddles(const harmonic::Annulus& ribbon, const std::vector<harmonic::Cut>& cuts);
  /// Direction of the interpolant's gradient at a voxel, along the axes; zero off the ribbon.
  [[nodiscard]] Eigen::Vector3f slopeAt(int i, int j, int k) const;
  [[nodiscard]] Vector direction(const Vector& index, const Vector& previous) const;
  /// True if the nearest white matter lies ahead: the middle between two banks was passed.
  /// @param near  as of bankAt()
  [[nodiscard]] bool pastMiddle(const Point& p, const Vector& direction, std::int32_t& near) const;
  /// Ends a path where it no longer leaves white matter behind: from there it only follows the
  /// floor between two banks.
  /// @param near  as of bankAt()
  void cutWhereItStalls(Trajectory& path, std::int32_t near) const;

  const CorticalTissue& tissue_;
  geometry::FaceTree white_;
  const Grid& grid_;
  double step_;
  double longest_ = 0;                  ///< of a trajectory, mm; none is longer but by going astray
  harmonic::Annulus annulus_;           ///< with cuts in buried sulci
  std::vector<Eigen::Vector3f> slope_;  ///< per tissue number: unit vector, along the axes
  std::vector<std::uint8_t> nearMiddle_;  ///< per voxel
  std::int64_t cutLinks_ = 0;
};

}  // namespace explica::surface
