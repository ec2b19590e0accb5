// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Core/Termination.h"
#include "Explica/Core/Types.h"

#include <algorithm>
#include <functional>

namespace explica::geometry {

struct Descent {
  int iterations = 0;
  double energy = kNaN;
  Termination termination = Termination::NotRun;
};

struct DescentLimits {
  int maxIterations;
  double tolerance;  ///< of the energy: a step that promises less ends it
  double rounding;   ///< decrease that the energy can tell
};

/// Lowers an energy by Newton steps with halving, each held to Armijo's condition.
///
/// An iteration depends on nothing but the place, so that a run can go on from where it was
/// stopped.
/// @param problem  value(place); findStep(place), false where there is none; promised(), minus the
///                 energy's slope along the step; largestShare(place) of the step that is allowed;
///                 moved(place, share)
/// @param taken    called after every step with the number of iterations
template <class Problem, class Place>
Descent lowerByNewton(Problem& problem, Place& place, const DescentLimits& limits,
                      const Monitor& monitor, const std::function<void(int)>& taken = {}) {
  constexpr double kSufficient = 1e-4;  // of the decrease that is promised [Armijo1966]
  Descent run{.energy = problem.value(place), .termination = Termination::MaxIterations};
  const auto endedBy = [&run](Termination end) { return Descent{run.iterations, run.energy, end}; };
  while (run.iterations < limits.maxIterations) {
    if (monitor.shouldStop()) return endedBy(Termination::Interrupted);
    if (!problem.findStep(place)) return endedBy(Termination::Stalled);
    const double promised = problem.promised();
    if (promised <= std::max(limits.tolerance * run.energy, limits.rounding)) {
      return endedBy(Termination::Converged);
    }
    double share = problem.largestShare(place);
    bool lower = false;
    for (int halving = 0; halving < 30 && !lower; ++halving, share /= 2) {
      Place tried = problem.moved(place, share);
      const double energy = problem.value(tried);
      if (!(energy <= run.energy - kSufficient * share * promised)) continue;
      place.swap(tried);
      run.energy = energy;
      lower = true;
    }
    ++run.iterations;
    if (!lower) return endedBy(Termination::Stalled);
    if (taken) taken(run.iterations);
  }
  return run;
}

}  // namespace explica::geometry
