// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Termination.h"
#include "Explica/Harmonic/Annulus.h"

#include <memory>
#include <vector>

namespace explica::harmonic {

/// When the solve may stop.
struct InterpolantOptions {
  double relativeTolerance = 1e-9;  ///< stop once |b - A u| <= relativeTolerance |b|, rows scaled
                                    ///< to unit diagonal
  int maxIterations = 200;          ///< BiCGStab iterations, two V-cycles each
};

/// The interpolant and an account of the solve.
struct Interpolant {
  std::vector<double> u;                  ///< per tissue number, in [0, 1]
  std::vector<Eigen::Vector3f> gradient;  ///< per tissue number, 1/mm along the grid's axes i, j, k
  Termination termination = Termination::NotRun;
  int iterations = 0;
  double relativeResidual = kNaN;
  double misfit = kNaN;  ///< BoundaryModel::Embedding: root mean square of u minus 0 or 1 on the
                         ///< boundary; iterations then count those of the fit
  std::size_t corrected =
      0;  ///< values that round-off had carried out of [0, 1] before the last sweep
};

/// Harmonic interpolant across an annular tissue such as cortex or myocardium.
///
/// Laplace's equation [Jones2000]: div grad u = 0 in the tissue, u = 0 on the inner and u = 1 on
/// the outer boundary, no flux into insulated voxels.  Seven-point stencil; where a link ends at
/// fraction theta, the one-sided distance enters as in [ShortleyWeller1938]: second order in the
/// maximum norm. A is an M-matrix, so u stays in [0, 1]: the last step is a Gauss-Seidel sweep,
/// whose values are convex combinations.
///
/// With BoundaryModel::Embedding u = sum alpha_j u_j [thesis 3.2]: the values alpha_j at the grid's
/// vertices beside the tissue are those for which u is nearest to 0 and 1 where the boundaries
/// cross the grid's links.  Least squares, some tens of Laplace solves; the same order of accuracy.
///
/// The result does not depend on the number of threads.  Time O(n) for n tissue voxels.
/// @throws InvalidInput  an option out of range
/// Hitting `maxIterations` is reported in `termination`, not thrown.
[[nodiscard]] Interpolant solveInterpolant(const Annulus& annulus,
                                           const InterpolantOptions& options = {},
                                           const Monitor& monitor = {});

/// Gradient of u at tissue voxels, by the parabola through the two neighbours on each axis
/// (boundary values at their true distance), 1/mm along the grid's axes.
[[nodiscard]] std::vector<Eigen::Vector3f> gradientOf(const Annulus& annulus,
                                                      const std::vector<double>& u);

struct MultigridHierarchy;

/// Multigrid V(1,1) cycle for the tissue's Laplacian with homogeneous boundary values:
/// cell-centred, aggregates of 2 x 2 x 2 voxels that are connected through uncut links, red-black
/// Gauss-Seidel, sum restriction, linear prolongation [Wesseling1992, section 5.3].  Single
/// precision.
class Multigrid {
 public:
  explicit Multigrid(const Annulus& annulus);
  ~Multigrid();
  Multigrid(Multigrid&&) noexcept;
  Multigrid& operator=(Multigrid&&) noexcept;

  /// Approximate solution e of A e = r, where A has unit diagonal.
  void cycle(const std::vector<float>& r, std::vector<float>& e);
  [[nodiscard]] int levels() const;

 private:
  std::unique_ptr<MultigridHierarchy> hierarchy_;
};

}  // namespace explica::harmonic
