// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Energy.h"

#include "Explica/Core/Parallel.h"

namespace explica::unfolding {

Configuration::Configuration(const Patch& whose, const Positions& where,
                             const visibility::Viewpoints& seenFrom,
                             const Eigen::VectorXd& areaMultipliers,
                             std::span<const collision::Contact> near,
                             const repulsion::KnotEnergy* repulsion)
    : patch(whose),
      x(where),
      viewpoints(seenFrom),
      multipliers(areaMultipliers),
      contacts(near),
      knot(repulsion),
      shapes(patch.faces.size()) {
  constexpr std::size_t kGrain = 256;  // elements a task
  parallelFor(shapes.size(), kGrain,
              [&](std::size_t f) { shapes[f] = shapeOf(patch.faces[f], x); });
}

const std::vector<collision::ContactForce>& Configuration::contactForces() const {
  if (!forces_) forces_ = collision::contactForces(contacts, x);
  return *forces_;
}

void Energy::addStiffness(const Configuration& /*now*/, double /*strength*/,
                          const std::vector<std::int32_t>& /*unknown*/,
                          BlockSystem& /*system*/) const {}

}  // namespace explica::unfolding
