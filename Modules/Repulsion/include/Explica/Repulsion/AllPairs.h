// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Repulsion/KnotEnergy.h"
#include "Explica/Repulsion/PairIntegral.h"

namespace explica::repulsion {

class MovingSet;

/// Every pair of faces by accurate quadrature: the measure of the other evaluators.
/// O(moving faces * faces) time; exact gradient of the value it returns; deterministic.
class AllPairs : public KnotEnergy {
 public:
  /// @throws InvalidInput  as makeKnotEnergy
  AllPairs(const TriangleMesh& mesh, const std::vector<bool>& vertexMoves,
           PairAccuracy accuracy = PairAccuracy::Standard);
  ~AllPairs() override;

  [[nodiscard]] KnotValue evaluate(const Positions& positions) const override;

 private:
  std::unique_ptr<const MovingSet> set_;
  PairAccuracy accuracy_;
};

}  // namespace explica::repulsion
