// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Repulsion/KnotEnergy.h"
#include "Explica/Repulsion/PairIntegral.h"
#include "MovingSet.h"

#include <array>
#include <vector>

namespace explica::repulsion {

/// What a moving face contributes: its share of the energy and the derivatives by its corners.
struct FaceForce {
  double value = 0;
  std::array<Vector, 3> byCorner{Vector::Zero(), Vector::Zero(), Vector::Zero()};
};

/// Adds up, in a fixed order: the forces and both orders of all pairs of faces with common corners
/// and of the pairs given besides.
/// @param apart  pairs without common corners that `forces` lack, a moving face first
[[nodiscard]] KnotValue assemble(const MovingSet& set, const Positions& positions,
                                 const std::vector<FaceForce>& forces, PairAccuracy accuracy,
                                 const std::vector<std::array<std::int32_t, 2>>& apart = {});

}  // namespace explica::repulsion
