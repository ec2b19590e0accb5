// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Repulsion/KnotEnergy.h"

namespace explica::repulsion {

/// Knot energy by a tree code; time O(n log N) for n moving faces among N.
///
/// E = sum over quadrature points of w_q phi(x_q), phi(x) the integral of 1/|x - y|^2 dS(y).  Far
/// clusters of faces act on three points of each moving face by their area and its second moments;
/// nearer faces, and those with common corners, by the integrals of PairIntegral.h.  The tree of
/// the fixed faces is built once, that of the moving ones at every evaluation.
///
/// The gradient is that of the quadrature, but not of the choice of clusters.  Relative L2 error
/// with the default opening about 1e-3 of all pairs.  Deterministic.
class MultipoleTree : public KnotEnergy {
 public:
  /// @param opening  a cluster acts as one where its radius and the face's together are below this
  ///                 share of their distance; the error falls as its third power
  /// @throws InvalidInput  as makeKnotEnergy; an opening out of range
  MultipoleTree(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves,
                double opening = 0.45);
  ~MultipoleTree() override;

  [[nodiscard]] KnotValue evaluate(const Positions& positions) const override;

 private:
  struct State;
  std::unique_ptr<const State> state_;
};

}  // namespace explica::repulsion
