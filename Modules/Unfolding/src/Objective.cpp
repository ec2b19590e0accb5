// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Objective.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/PhaseClock.h"

namespace explica::unfolding {

namespace {

std::unique_ptr<Energy> makeEnergy(Term term) {
  switch (term) {
    case Term::Visibility:
      return makeVisibilityEnergy();
    case Term::Area:
      return makeAreaEnergy();
    case Term::Spring:
      return makeSpringEnergy();
    case Term::Lift:
      return makeLiftEnergy();
    case Term::Guide:
      return makeGuideEnergy();
    case Term::Collar:
      return makeCollarEnergy();
    case Term::Overhang:
      return makeOverhangEnergy();
    case Term::Contact:
      return makeContactEnergy();
    case Term::Knot:
      return makeKnotTerm();
  }
  throw InvalidInput("term: not one of kTerms");
}

}  // namespace

Objective::Objective() {
  for (std::size_t n = 0; n < kTermCount; ++n) energies_[n] = makeEnergy(kTerms[n].term);
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
