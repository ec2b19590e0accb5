// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "AreaProjection.h"
#include "UnfolderImplementation.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/PhaseClock.h"
#include "Explica/Visibility/AverageVisibility.h"

#include <cmath>

namespace explica::unfolding {

/// [Thesis, Eq. 5.46] with the sign that lets the knot energy fall, and [Thesis, Eq. 5.48].
bool Unfolder::Implementation::thesisStep() {
  const Positions& x = state.positions;
  IterationRecord now;
  now.iteration = state.iteration + 1;
  visibility::VisibilityValue average;
  {
    const PhaseClock clock(now.phases.visibility);
    average =
        visibility::AverageVisibility(setup.mesh.faces, setup.region.faces, viewpoints).evaluate(x);
  }
  Positions velocity = average.area * average.gradient;
  if (knot) {
    const PhaseClock clock(now.phases.repulsion);
    const repulsion::KnotValue value = knot->evaluate(x);
    velocity -= options.weights[Term::Knot] * value.gradient;
    now.energies[Term::Knot] = options.weights[Term::Knot] * value.value;
  }
  for (Eigen::Index v = 0; v < velocity.rows(); ++v) {
    if (setup.unknown[v] < 0) velocity.row(v).setZero();
  }
  if (options.keepAreas) {
    const PhaseClock clock(now.phases.solve);
    now.solves = keepAreas(setup.patch, x, setup.unknown, velocity);
  }
  const double fastest = std::sqrt(velocity.rowwise().squaredNorm().maxCoeff());
  if (!(fastest > 0)) {
    state.stalled = true;
    return false;
  }
  constexpr double kMove = 0.05;  // mean edge lengths: about as far as areas stay linear
  now.largestMove = kMove * setup.edge;
  now.step = now.largestMove / fastest;
  now.energies[Term::Visibility] = average.area * (1 - average.value);
  now.objectiveBefore = now.energies.sum();
  state.positions += now.step * velocity;
  state.iteration = now.iteration;
  contacts.forget();
  measure(now);
  now.objectiveAfter = kNaN;  // a flow: no search along the line
  record = now;
  if (!state.positions.allFinite()) throw InvalidInput("knot-weight: too large, the flow diverged");
  return true;
}

}  // namespace explica::unfolding
