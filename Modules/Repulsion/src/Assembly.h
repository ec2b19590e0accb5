// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Repulsion/KnotEnergy.h"
#include "Explica/Repulsion/PairIntegral.h"
#include "MovingSet.h"

#include <vector>

namespace explica::repulsion {

/// What a moving face contributes: its share of the energy and the derivatives by its corners.
struct FaceForce {
  double value = 0;
  std::array<Vector, 3> byCorner{Vector::Zero(), Vector::Zero(), Vector::Zero()};
};

/// Energy of all pairs of faces with common corners: edge pairs first, then vertex pairs.
[[nodiscard]] std::vector<PairIntegral> adjacentPairs(const MovingSet& set,
                                                      const Positions& positions,
                                                      PairAccuracy accuracy);

/// Adds up in a fixed order.  `adjacent` as adjacentPairs() returns it; both of its orders count.
[[nodiscard]] KnotValue assemble(const MovingSet& set, const Positions& positions,
                                 const std::vector<FaceForce>& forces,
                                 const std::vector<PairIntegral>& adjacent);

}  // namespace explica::repulsion
