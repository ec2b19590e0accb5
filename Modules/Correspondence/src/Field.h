// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Correspondence/Trajectory.h"
#include "WalkKernels.h"

#include <array>
#include <cstdint>
#include <vector>

namespace explica::correspondence {

inline constexpr int kMaxSteps = 4000;  ///< of a trajectory, before it counts as lost

/// u and its gradient between voxel centres.  Positions are continuous indices of the annulus' box;
/// gradients are per voxel (index space), so that du = G . dx.
struct TrajectoryTracer::Field {
  /// Gradient per voxel and u.
  using Corner = Eigen::Array4f;

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

  [[nodiscard]] Trace run(Walk walk, double target, int uphill) const;

  /// Where a walk from any point begins.
  struct Start {
    Walk walk;
    int uphill = 1;
    double lead = 0;  ///< mm of straight way to it, if the point's own cell has no tissue
  };
  /// Nothing if no tissue is within two voxels.
  [[nodiscard]] std::optional<Start> startAt(const Point& point, double target) const;

  /// Follows trajectories to the target, a few beside each other; each goes as it would alone.
  /// @param next    next(walk) begins a walk and gives the rank of its voxel; -1 after the last one
  /// @param ended   ended(rank, walk, done) takes each, in no particular order
  template <class Next, class Ended>
  void followEach(double target, int uphill, const Next& next, const Ended& ended) const;

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

  void rankTissue();
  void prepareCells();
  /// Corners from the side of `seed`; a bit per corner that belongs to it.
  std::uint8_t extend(const std::int32_t* number, int seed, Corner* corner) const;
  void prepareSides();
  enum class Outcome { Again, Advanced, Arrived };
  /// Makes walk.step no longer than it may be where the walk is.
  void limitStep(Walk& walk, double target, int uphill) const;
  /// Tries the next step of each walk.
  void attempt(const Walk* walks, StepLanes& tries, int count, int uphill) const;
  /// Takes a step that was tried in a lane, or makes it shorter to be tried again.
  Outcome conclude(Walk& walk, const StepLanes& tries, int lane, double target, int uphill) const;
  /// Ends a walk at the target, which a step that was tried has passed.
  void arrive(Walk& walk, const StepLanes& tries, int lane, double target, int uphill) const;
  /// Tissue voxel of the cell where a step ends: the nearest one if it is the side's.
  [[nodiscard]] std::int32_t homeAtEnd(const StepLanes& tries, int lane) const;
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
  FieldView view_;
};

template <class Next, class Ended>
void TrajectoryTracer::Field::followEach(double target, int uphill, const Next& next,
                                         const Ended& ended) const {
  std::array<Walk, kBeside> walks;
  StepLanes tries;
  std::array<std::int32_t, kBeside> rank{}, steps{};
  int count = 0;
  const auto beginNext = [&](int w) {
    for (;;) {
      rank[w] = next(walks[w]);
      if (rank[w] < 0) return false;
      steps[w] = 0;
      const bool done = uphill * (walks[w].u - target) >= 0;
      if (!done && !walks[w].stuck) break;
      ended(rank[w], walks[w], done);
    }
    limitStep(walks[w], target, uphill);
    return true;
  };
  /// Whether the walk goes on.
  const auto goesOn = [&](int w) {
    Walk& walk = walks[w];
    const Outcome outcome = conclude(walk, tries, w, target, uphill);
    if (outcome == Outcome::Again) return true;
    const bool done = outcome == Outcome::Arrived || (walk.stuck && hop(walk, target, uphill));
    if (done || walk.stuck || ++steps[w] >= kMaxSteps) {
      ended(rank[w], walk, done);
      return false;
    }
    limitStep(walk, target, uphill);
    return true;
  };
  while (count < kBeside && beginNext(count)) ++count;
  while (count > 0) {
    attempt(walks.data(), tries, count, uphill);
    for (int w = count - 1; w >= 0; --w) {
      if (goesOn(w) || beginNext(w)) continue;
      --count;
      walks[w] = walks[count];
      rank[w] = rank[count];
      steps[w] = steps[count];
    }
  }
}

}  // namespace explica::correspondence
