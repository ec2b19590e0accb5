// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Objective.h"

#include "Explica/Core/PhaseClock.h"

namespace explica::unfolding {

Objective::Objective() {
  makeFaceTerms(energies_);
  makeOtherTerms(energies_);
}

double Objective::value(const Configuration& now, const TermValues& strengths,
                        IterationRecord& account) const {
  for (std::size_t n = 0; n < kTermCount; ++n) {
    const PhaseClock clock(account.phases.*energies_[n]->phase());
    account.energies.values[n] = energies_[n]->value(now, strengths.values[n]);
  }
  return account.energies.sum();
}

Positions Objective::gradient(const Configuration& now, const TermValues& strengths,
                              IterationRecord& account) const {
  Positions gradient = Positions::Zero(now.x.rows(), 3);
  for (std::size_t n = 0; n < kTermCount; ++n) {
    const PhaseClock clock(account.phases.*energies_[n]->phase());
    energies_[n]->addGradient(now, strengths.values[n], gradient);
  }
  return gradient;
}

void Objective::addStiffness(const Configuration& now, const TermValues& strengths,
                             const std::vector<std::int32_t>& unknown, BlockSystem& system) const {
  for (std::size_t n = 0; n < kTermCount; ++n) {
    energies_[n]->addStiffness(now, strengths.values[n], unknown, system);
  }
}

}  // namespace explica::unfolding
