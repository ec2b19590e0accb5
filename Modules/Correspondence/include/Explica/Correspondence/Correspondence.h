// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Correspondence/Trajectory.h"

#include <array>
#include <optional>
#include <vector>

namespace explica::correspondence {

/// How correspondences are found [thesis 3.1].
enum class Method {
  Hybrid,      ///< trajectories followed to the first grid face whose corners agree; second order
  AppendixA,   ///< the hybrid of the thesis's appendix A to the letter, lambda its dial
  Eulerian,    ///< ordered sweep alone, boundary values at grid points [YezziPrince2003]
  Lagrangian,  ///< every trajectory followed to the boundary; with a lambda, the hybrid
};
constexpr auto enumWords(Method) {
  using enum Method;
  return std::to_array<EnumWord<Method>>({{Hybrid, "hybrid"},
                                          {AppendixA, "appendix-a"},
                                          {Eulerian, "eulerian"},
                                          {Lagrangian, "lagrangian"}});
}

struct CorrespondenceOptions {
  Method method = Method::Lagrangian;
  std::optional<double> lambda;  ///< mm; of `Hybrid` and `AppendixA`: neighbours' boundary points
                                 ///< nearer than this are interpolated, others followed; 0 gives
                                 ///< the Lagrangian result, infinity follows none beyond a grid
                                 ///< face; unset: sqrt(2) times the longest diagonal of a grid face
  TraceOptions trace = {.maxStep = kInfinity};
};

template <class Visitor>
void describe(CorrespondenceOptions& options, Visitor&& visit) {
  visit(Field{"method", "", "how boundary points and lengths are found"}, options.method);
  visit(
      Field{"lambda", "mm",
            "boundary points of neighbours nearer than this are interpolated (hybrid, appendix-a), "
            "others followed; 0 follows all (default: all are followed; of those two methods 1.4 "
            "times the longest diagonal of a grid face)",
            0},
      options.lambda);
}

/// Boundary points and lengths of every tissue voxel.
struct Correspondence {
  std::vector<double> innerDistance;        ///< L0, mm; NaN if the trajectory did not arrive
  std::vector<double> outerDistance;        ///< L1, mm
  std::vector<Eigen::Vector3f> innerPoint;  ///< phi0 minus the voxel's centre, RAS mm
  std::vector<Eigen::Vector3f> outerPoint;  ///< phi1 minus the voxel's centre, RAS mm
  std::size_t traced = 0;   ///< values found by following a trajectory to the boundary or to a face
  std::size_t missing = 0;  ///< voxels with a length that is NaN

  [[nodiscard]] double thickness(std::size_t n) const {
    return innerDistance[n] + outerDistance[n];
  }
};

/// Correspondences across the tissue: phi0 and phi1 are constant along T = grad u / |grad u| with
/// phi0 = x on the inner and phi1 = x on the outer boundary; grad L0 . T = 1.
///
/// Lagrangian: every trajectory is followed to the boundary, eight at a time on each thread, by
/// steps that grow to half of what is left of the way: their number grows as the logarithm of the
/// tissue's thickness in voxels.
///
/// AppendixA: the thesis's appendix A to the letter. A voxel whose upwind neighbours' boundary
/// points are all nearer to each other than lambda takes (3.1) of them, which is of first order;
/// any other follows its trajectory to the first line (in space: face) between solved grid points
/// that agree within lambda and interpolates linearly there. One sweep sorted by u stands for the
/// heap: the unsolved point of least u always has a solved neighbour, so it is on the heap's top.
/// Upwind neighbours are a voxel's diagonal apart, and so are their boundary points where
/// trajectories run in parallel: the error depends on lambda below that, and rises to the sweep's
/// with better boundary values above it.
///
/// Hybrid: never takes (3.1). In the order of u, every trajectory is followed at least to the first
/// grid face ahead whose corners were found before, where the arrivals are interpolated with their
/// second differences. So each voxel adds an error of third order where (3.1) adds one of second,
/// and lambda only says which faces are passed by because trajectories part there: the error is
/// near the Lagrangian's for every lambda, up to infinity.
///
/// No result depends on the number of threads.
[[nodiscard]] Correspondence findCorrespondences(const harmonic::Annulus& annulus,
                                                 const harmonic::Interpolant& interpolant,
                                                 const CorrespondenceOptions& options = {},
                                                 const Monitor& monitor = {});

/// L0 + L1 per tissue voxel.
[[nodiscard]] std::vector<double> thicknessOf(const Correspondence& correspondence);

/// Thickness at a point, mm: trilinear in that of the voxels around; nothing if those with
/// thickness have less than a quarter of the weight.
[[nodiscard]] std::optional<double> thicknessAt(const harmonic::Annulus& annulus,
                                                const Correspondence& correspondence,
                                                const Point& point);

/// What a voxel counts in a sum over the middle surface, 1/mm: 2 (1 - |2 d - 1|) / t at the depth d
/// in [0, 1]; 0 where t is not known.
///
/// Its integral along a column of thickness t is the column's cross-section at half depth, as long
/// as that changes evenly.
[[nodiscard]] double columnWeight(const Correspondence& correspondence, std::size_t n);

/// Of the voxels whose thickness is known, mm.  A mean over voxels weighs each column of tissue by
/// its volume, that over the middle surface by its cross-section there.
struct ThicknessSummary {
  double mean = kNaN;  ///< over the middle surface
  double meanOfVoxels = kNaN, median = kNaN, p05 = kNaN, p95 = kNaN;
};
[[nodiscard]] ThicknessSummary summaryOf(const Correspondence& correspondence);

}  // namespace explica::correspondence
