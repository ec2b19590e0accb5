// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Correspondence/Trajectory.h"

#include <array>
#include <cstdint>
#include <vector>

namespace explica::correspondence {

/// u and its gradient between voxel centres.  Positions are continuous indices of the annulus' box;
/// gradients are per voxel (index space), so that du = G . dx.
struct TrajectoryTracer::Field {
  struct Sample {
    double u = kNaN;
    Vector gradient = Vector::Zero();
    std::int32_t home = -1;  ///< nearest tissue voxel of this side; -1: no tissue in the cell
    bool divided = false;    ///< the cell has more than one side
  };

  /// State of a walk along a trajectory.
  struct Walk {
    Vector x = Vector::Zero();
    Vector velocity = Vector::Zero();  ///< dx / ds, voxels per mm
    std::int32_t home = -1;
    double u = kNaN;
    double length = 0;     ///< mm so far
    double step = 0;       ///< next step to try, mm
    double slope = 0;      ///< |grad u| here, 1/mm
    bool divided = false;  ///< the last cell has more than one side
    int strikes = 0;       ///< steps along which u did not change as its gradient says
    int hops = 0;          ///< from voxel to voxel, where the field between them led nowhere
    bool stuck = false;
  };

  Field(const harmonic::Annulus& a, const harmonic::Interpolant& i, const TraceOptions& o);

  /// @param home  tissue voxel that tells the side, or -1
  [[nodiscard]] Sample sample(const Vector& x, std::int32_t home) const;

  [[nodiscard]] Walk begin(const Vector& x, std::int32_t home, int uphill) const;
  /// @param place  tissue voxel's place in the box
  [[nodiscard]] Walk begin(std::int32_t place, int uphill) const;

  /// One accepted step towards the target; true when it was reached (the walk then ends on it).
  bool advance(Walk& walk, double target, int uphill) const;

  /// One step of third order from a tissue voxel's centre to just beyond the first grid plane.
  /// False, and nothing done, if it leaves the tissue, or more than one side or a greater error
  /// than the tolerance is in the way.
  /// @param length  mm of the step
  bool toPlane(std::int32_t rank, const std::array<int, 3>& centre, int uphill, Vector& end,
               double& length) const;

  /// Cell that the trajectory through a tissue voxel's centre enters: its lowest corner in the box.
  [[nodiscard]] std::int32_t cellAhead(std::int32_t rank, int uphill) const;
  /// Brings what sampling a cell reads towards the caches: what its corners are, and, once that has
  /// arrived, the corners.
  void fetchCell(std::int32_t cell) const;
  void fetchCorners(std::int32_t cell) const;

  [[nodiscard]] Trace run(Walk walk, double target, int uphill) const;

  /// Tissue voxel to start from for any point: in its cell, else the nearest within two voxels.
  [[nodiscard]] std::int32_t homeOf(const Vector& x) const;

  [[nodiscard]] Vector toBox(const Point& world) const;
  [[nodiscard]] Point toWorld(const Vector& x) const;

  const harmonic::Annulus& annulus;
  const harmonic::Interpolant& interpolant;
  TraceOptions options;
  double finest = 1;  ///< mm
  Vector inverseSpacing;
  bool flat = false;                ///< two-dimensional
  std::vector<std::uint8_t> onCut;  ///< per tissue voxel: a link to tissue is cut; empty if none is

  /// Gradient per voxel and u.
  using Corner = Eigen::Array4f;
  // Neighbours in space are neighbours in memory when tissue is ranked in the box's storage order.
  std::vector<std::int32_t> rankAt;   ///< per box voxel; -1: no tissue
  std::vector<std::int32_t> placeOf;  ///< per rank, the box voxel
  std::vector<Corner> node;           ///< per rank

 private:
  /// The corners of a cell next to a boundary, extended from the only side it has.
  struct Cell {
    std::array<Corner, 8> corner;
  };
  /// One side of a cell that has several.
  struct Side {
    std::uint8_t corners = 0;  ///< its own, a bit each
    Cell cell;
  };
  /// kDivided - n: the cell whose sides start at firstSide_[n].
  enum : std::int32_t { kWhole = -1, kEmpty = -2, kDivided = -3 };

  template <bool kWithU>
  [[nodiscard]] Sample sampleOf(const Vector& x, std::int32_t home) const;
  void rankTissue();
  void prepareCells();
  /// Corners from the side of `seed`; a bit per corner that belongs to it.
  std::uint8_t extend(const std::int32_t* number, int seed, Corner* corner) const;
  void prepareSides();
  bool advanceAlong(Walk& walk, double target, int uphill) const;
  /// Takes a walk that is stuck straight to the boundary beside its voxel or to the neighbour
  /// towards which u gains most: a harmonic function has such a one everywhere, so that the walk
  /// gets on where the field between voxels leads nowhere, as it may at the edges of sheets.
  /// True if the walk has arrived; it stays stuck where u is flat.
  bool hop(Walk& walk, double target, int uphill) const;
  /// mm of the step after one with this error estimate.
  [[nodiscard]] double stepAfter(double step, double error) const;
  /// Ends a walk on a straight line if the target is near; else it is stuck.
  bool goStraight(Walk& walk, double target, int uphill) const;
  [[nodiscard]] Vector velocityOf(const Sample& sample, int uphill, double* slope = nullptr) const;

  std::vector<std::int32_t> cellAt_;  ///< per box voxel, the cell with it as lowest corner: row of
                                      ///< cells_, or what else
  std::vector<Cell> cells_;
  std::vector<Side> sides_;
  std::vector<std::int32_t> firstSide_;  ///< of each divided cell, and the end
};

}  // namespace explica::correspondence
