// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Energy.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/PhaseClock.h"

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

Objective::Objective() {
  makeFaceTerms(terms_);
  makeOtherTerms(terms_);
}

double Objective::value(const Configuration& now, const TermValues& strengths,
                        IterationRecord& account) const {
  for (std::size_t n = 0; n < kTermCount; ++n) {
    const PhaseClock clock(account.phases.*terms_[n]->phase());
    account.energies.values[n] = terms_[n]->value(now, strengths.values[n]);
  }
  return account.energies.sum();
}

Positions Objective::gradient(const Configuration& now, const TermValues& strengths,
                              IterationRecord& account) const {
  Positions gradient = Positions::Zero(now.x.rows(), 3);
  for (std::size_t n = 0; n < kTermCount; ++n) {
    const PhaseClock clock(account.phases.*terms_[n]->phase());
    terms_[n]->addGradient(now, strengths.values[n], gradient);
  }
  return gradient;
}

void Objective::addStiffness(const Configuration& now, const TermValues& strengths,
                             const std::vector<std::int32_t>& unknown, BlockSystem& system) const {
  for (std::size_t n = 0; n < kTermCount; ++n) {
    terms_[n]->addStiffness(now, strengths.values[n], unknown, system);
  }
}

}  // namespace explica::unfolding
