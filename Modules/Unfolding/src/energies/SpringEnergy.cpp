// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Energy.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

/// r(s) = 2 s^2 / (1 + sqrt(1 + (s / d)^2)), d the strain of yielding; its slope is 2 s times
/// softening(s, d).
double costOf(double strain, double yield) {
  const double share = strain / yield;
  return 2 * strain * strain / (1 + std::sqrt(1 + share * share));
}
double softening(double strain, double yield) {
  const double share = strain / yield;
  return 1 / std::sqrt(1 + share * share);
}

/// strength * sum over the region's edges of e r(l / l0 - 1).
class SpringEnergy final : public Energy {
 public:
  [[nodiscard]] double value(const Configuration& now, double strength) const override {
    return springValue(now.patch.regionEdges(), now.patch.yieldStrain, now.x, strength);
  }
  void addGradient(const Configuration& now, double strength, Positions& gradient) const override {
    addSpringGradient(now.patch.regionEdges(), now.patch.yieldStrain, now.x, strength, gradient);
  }
  void addStiffness(const Configuration& now, double strength,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const override {
    addSpringStiffness(now.patch, 0, now.patch.regionSprings, now.x, strength, unknown, system);
  }
};

}  // namespace

double springValue(std::span<const PatchSpring> springs, double yield, const Positions& x,
                   double strength) {
  constexpr std::size_t kGrain = 256;  // elements a task
  return parallelSum(springs.size(), kGrain, 0.0, [&](std::size_t begin, std::size_t end) {
    double block = 0;
    for (std::size_t s = begin; s < end; ++s) {
      const double strain = lengthOf(springs[s], x) / springs[s].restLength - 1;
      block += strength * springs[s].weight * costOf(strain, yield);
    }
    return block;
  });
}

void addSpringGradient(std::span<const PatchSpring> springs, double yield, const Positions& x,
                       double strength, Positions& gradient) {
  for (const PatchSpring& spring : springs) {
    const Eigen::RowVector3d along = x.row(spring.vertices[1]) - x.row(spring.vertices[0]);
    const double length = along.norm();
    const double strain = length / spring.restLength - 1;
    const Eigen::RowVector3d pull = 2 * strength * spring.weight * strain *
                                    softening(strain, yield) / spring.restLength / length * along;
    gradient.row(spring.vertices[0]) -= pull;
    gradient.row(spring.vertices[1]) += pull;
  }
}

void addSpringStiffness(const Patch& patch, std::size_t first, std::size_t count,
                        const Positions& x, double strength,
                        const std::vector<std::int32_t>& unknown, BlockSystem& system) {
  constexpr std::size_t kGrain = 256;  // elements a task
  std::vector<Eigen::Matrix3d> blocks(count);
  parallelFor(count, kGrain, [&](std::size_t s) {
    const PatchSpring& spring = patch.springs[first + s];
    const Vector along = (x.row(spring.vertices[1]) - x.row(spring.vertices[0])).transpose();
    const double length = along.norm();
    const Vector unit = along / length;
    const double soft = softening(length / spring.restLength - 1, patch.yieldStrain);
    const double secant =
        2 * strength * spring.weight * soft / (spring.restLength * spring.restLength);
    const double lateral = secant * std::max(0.0, 1 - spring.restLength / length);
    const double stiffness = secant * soft;
    blocks[s] =
        (stiffness - lateral) * unit * unit.transpose() + lateral * Eigen::Matrix3d::Identity();
  });
  const auto verticesOf = [&](std::int32_t s) { return patch.springs[s].vertices; };
  addBlocks(patch.springsAround, first, count, verticesOf, unknown, system,
            [&](std::int32_t s, int i, int j) -> Eigen::Matrix3d {
              const Eigen::Matrix3d& block = blocks[static_cast<std::size_t>(s) - first];
              if (i == j) return block;
              return -block.transpose();
            });
}

std::unique_ptr<Energy> makeSpringEnergy() {
  return std::make_unique<SpringEnergy>();
}

}  // namespace explica::unfolding
