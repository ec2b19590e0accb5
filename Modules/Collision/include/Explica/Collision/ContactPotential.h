// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Collision/CollisionScene.h"

#include <span>
#include <vector>

namespace explica::collision {

/// A pair with the range of its barrier.
struct Contact {
  std::array<std::int32_t, 4> vertices = {-1, -1, -1, -1};
  PairKind kind = PairKind::VertexFace;
  double range = 0;  ///< mm: the barrier acts below this distance
  /// mm^4, edge pairs: below this |u x v|^2 of the edges u, v the barrier fades out, since the
  /// distance of parallel edges has a kink there and vertex-face pairs hold them apart.
  double parallelArea = 0;
  double softBelow = 0;  ///< of the range: see evaluateBarrier()
};

/// One contact's share of the potential's derivatives.
struct ContactForce {
  Vector12 gradient = Vector12::Zero();   ///< of the potential by the four points, mm^-1
  Vector12 direction = Vector12::Zero();  ///< gradient of the distance
  double curvature = 0;  ///< mm^-2, >= 0: stiffness direction * direction^T, positive semi-definite
};

/// Those of the contacts that are nearer than their range, in their order.  Threaded.
[[nodiscard]] std::vector<Contact> contactsWithin(std::span<const Contact> contacts,
                                                  const Positions& positions);

/// Sum of barriers over contacts, no unit; infinite if a pair without softBelow touches.  Threaded,
/// deterministic.
[[nodiscard]] double contactEnergy(std::span<const Contact> contacts, const Positions& positions);

/// Derivatives contact by contact, in their order.
[[nodiscard]] std::vector<ContactForce> contactForces(std::span<const Contact> contacts,
                                                      const Positions& positions);

}  // namespace explica::collision
