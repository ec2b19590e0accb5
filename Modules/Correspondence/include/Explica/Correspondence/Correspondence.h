// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Correspondence/Trajectory.h"

#include <array>
#include <optional>
#include <utility>
#include <vector>

namespace explica::correspondence {

/// How correspondences are found [thesis 3.1].
enum class Method {
  Hybrid,     ///< ordered sweep that follows a trajectory where its neighbours disagree
  Eulerian,   ///< ordered sweep alone, boundary values at grid points [YezziPrince2003]
  Lagrangian  ///< every trajectory followed to the boundary
};

struct CorrespondenceOptions {
  Method method = Method::Hybrid;
  std::optional<double>
      lambda;  ///< mm; neighbours' boundary points nearer than this are
               ///< interpolated; 0 gives the Lagrangian result, infinity the
               ///< sweep with better boundary values; unset: twice the finest spacing
  TraceOptions trace;
};

template <class Visitor>
void describe(CorrespondenceOptions& options, Visitor&& visit) {
  visit(Field{"method", "", "how boundary points and lengths are found"}, options.method);
  visit(Field{"lambda", "mm",
              "hybrid: boundary points of neighbours nearer than this are interpolated, others "
              "followed; 0 follows all (default: twice the finest voxel size)"},
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
/// Hybrid: the algorithm of the thesis's appendix A, with one sweep sorted by u in place of the
/// heap (a voxel's upwind neighbours have smaller u, so the order is the same), in 3D with faces
/// for line segments and bilinear interpolation on them. The result does not depend on the number
/// of threads.
[[nodiscard]] Correspondence findCorrespondences(const harmonic::Annulus& annulus,
                                                 const harmonic::Interpolant& interpolant,
                                                 const CorrespondenceOptions& options = {},
                                                 const Monitor& monitor = {});

/// L0 + L1 per tissue voxel.
[[nodiscard]] std::vector<double> thicknessOf(const Correspondence& correspondence);

/// Of the voxels whose thickness is known, mm.
///
/// A mean over voxels weighs each column of tissue by its thickness, for a thick column holds more
/// voxels; the mean over columns, n / sum(1/t), weighs all columns alike, as a surface does.
struct ThicknessSummary {
  double meanOfColumns = kNaN;
  double mean = kNaN, median = kNaN, p05 = kNaN, p95 = kNaN;
};
[[nodiscard]] ThicknessSummary summaryOf(const Correspondence& correspondence);

}  // namespace explica::correspondence

namespace explica {

template <>
struct EnumNames<correspondence::Method> {
  static constexpr std::array table{std::pair{correspondence::Method::Hybrid, "hybrid"},
                                    std::pair{correspondence::Method::Eulerian, "eulerian"},
                                    std::pair{correspondence::Method::Lagrangian, "lagrangian"}};
};

}  // namespace explica
