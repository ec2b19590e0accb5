// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Repulsion/KnotEnergy.h"

namespace explica::repulsion {

/// How far the multipole tree goes for its accuracy.
struct MultipoleTreeOptions {
  /// A cluster of sources counts by its moments once its radius is below this share of its distance
  /// from the targets; the relative error grows as its third to fifth power.
  double opening = 0.45;
  /// Pairs of faces whose centroids are at least this many sums of radii apart are integrated by
  /// three points each; nearer ones by seven or more.
  double nearRatio = 1.1;
};

/// Knot energy by a tree code; time O(n log N) for n moving faces among N.
///
/// E = sum over quadrature points of w_q phi(x_q), phi(x) the integral of 1/|x - y|^2 dS(y). Moving
/// faces are grouped by sixteen and count by three points each.  On these act far clusters of
/// sources by their second moments, close faces by three points, near ones by product Gauss rules
/// on subdivided faces, faces with common corners by the regular integrals that remain once the
/// singularity is integrated exactly (PairIntegral.h).  The tree of the fixed faces is built once,
/// that of the moving faces at every evaluation.
///
/// Clusters and points are summed in vectors of single precision: the value carries noise of about
/// 1e-7 of itself. The gradient is that of the quadrature, but not of the choice of clusters.
/// Relative L2 error with the default options: of the value below 1e-3 of all pairs; of the
/// gradient below 1e-3 on patches of folded surfaces, up to 1e-2 on fine closed ones, where the
/// forces of neighbours cancel (README.md).  Result independent of the number of threads; the last
/// digits depend on the machine's vector instructions.
class MultipoleTree : public KnotEnergy {
 public:
  /// @throws InvalidInput  as makeKnotEnergy; an option out of range
  MultipoleTree(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves,
                const MultipoleTreeOptions& options = {});
  ~MultipoleTree() override;

  [[nodiscard]] KnotValue evaluate(const Positions& positions) const override;

  /// Name of the vector instruction set in use, for records.
  [[nodiscard]] static const char* instructionSet();

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace explica::repulsion
