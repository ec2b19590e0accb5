// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Energy.h"

namespace explica::unfolding {
namespace {

/// strength * sum over pairs within range of the clamped log barrier of their distance: see
/// Collision/ContactPotential.h.
class ContactEnergy final : public Energy {
 public:
  [[nodiscard]] double value(const Configuration& now, double strength) const override {
    return strength * collision::contactEnergy(now.contacts, now.x);
  }

  void addGradient(const Configuration& now, double strength, Positions& gradient) const override {
    const auto& forces = now.contactForces();
    for (std::size_t n = 0; n < forces.size(); ++n) {
      for (int i = 0; i < 4; ++i) {
        gradient.row(now.contacts[n].vertices[i]) +=
            strength * forces[n].gradient.segment<3>(3 * i).transpose();
      }
    }
  }

  void addStiffness(const Configuration& now, double strength,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const override {
    const auto& forces = now.contactForces();
    std::vector<std::size_t> acting;
    for (std::size_t n = 0; n < forces.size(); ++n) {
      if (forces[n].curvature != 0) acting.push_back(n);
    }
    const auto verticesOf = [&](std::size_t a) { return now.contacts[acting[a]].vertices; };
    const Around around(acting.size(), unknown, verticesOf);
    addBlocks(around, 0, acting.size(), verticesOf, unknown, system,
              [&](std::int32_t a, int i, int j) -> Eigen::Matrix3d {
                const collision::ContactForce& force = forces[acting[a]];
                return strength * force.curvature * force.direction.segment<3>(3 * i) *
                       force.direction.segment<3>(3 * j).transpose();
              });
  }

  [[nodiscard]] double PhaseSeconds::*phase() const override { return &PhaseSeconds::collision; }
};

}  // namespace

std::unique_ptr<Energy> makeContactEnergy() {
  return std::make_unique<ContactEnergy>();
}

}  // namespace explica::unfolding
