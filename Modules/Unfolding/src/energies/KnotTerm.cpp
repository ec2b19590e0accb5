// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Energy.h"

namespace explica::unfolding {
namespace {

/// strength * knot energy [Thesis, Eq. 5.39], see Repulsion/KnotEnergy.h; steps take it as linear.
class KnotTerm final : public Energy {
 public:
  [[nodiscard]] double value(const Configuration& now, double strength) const override {
    return now.knot ? strength * now.knot->value(now.x) : 0;
  }
  void addGradient(const Configuration& now, double strength, Positions& gradient) const override {
    if (now.knot) gradient += strength * now.knot->evaluate(now.x).gradient;
  }
  [[nodiscard]] double PhaseSeconds::*phase() const override { return &PhaseSeconds::repulsion; }
};

}  // namespace

std::unique_ptr<Energy> makeKnotTerm() {
  return std::make_unique<KnotTerm>();
}

}  // namespace explica::unfolding
