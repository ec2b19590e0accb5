// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Energy.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

constexpr std::size_t kGuideGrain = 1024;  // elements a task

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

// Of the guide's radius: nearer to its place a vertex is at home, where lengths and areas say how
// it lies.
constexpr double kHome = 0.02;

struct Pull {
  Vector towards = Vector::Zero();  ///< unit, normal to the axis; 0 at home
  double value = 0;                 ///< h
  double slope = 0;                 ///< h'
  double curvature = 0;             ///< of the parabola that touches there from above
};

/// h(s) = (s - kHome)^2 / 2, 0 below, on a straight line from kHome + kFirm on; s = |p - x| / R
/// across the axis.
Pull pullOn(const PatchGuide& guide, std::size_t n, const Positions& x) {
  Vector way =
      (guide.places.row(static_cast<Eigen::Index>(n)) - x.row(guide.vertices[n])).transpose();
  way -= guide.axis.dot(way) * guide.axis;
  const double s = way.norm() / guide.radius;
  if (!(s > kHome)) return {};
  const double slope = std::min(s - kHome, kFirm);
  return {way.normalized(), slope * (s - kHome - 0.5 * slope), slope, slope / s};
}

/// strength * sum over the guide's vertices of a h(|p - x| / R), |p - x| across the axis.
class GuideEnergy final : public Energy {
 public:
  [[nodiscard]] double value(const Configuration& now, double strength) const override {
    if (!(strength > 0)) return 0;
    const PatchGuide& guide = now.patch.guide;
    const auto sum = [&](std::size_t begin, std::size_t end) {
      double block = 0;
      for (std::size_t n = begin; n < end; ++n) {
        block += guide.weights[n] * pullOn(guide, n, now.x).value;
      }
      return block;
    };
    return strength * parallelSum(guide.vertices.size(), kGuideGrain, 0.0, sum);
  }

  void addGradient(const Configuration& now, double strength, Positions& gradient) const override {
    if (!(strength > 0)) return;
    const PatchGuide& guide = now.patch.guide;
    parallelFor(guide.vertices.size(), kGuideGrain, [&](std::size_t n) {
      const Pull pull = pullOn(guide, n, now.x);
      gradient.row(guide.vertices[n]) -=
          strength * guide.weights[n] / guide.radius * pull.slope * pull.towards.transpose();
    });
  }

  void addStiffness(const Configuration& now, double strength,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const override {
    if (!(strength > 0)) return;
    const PatchGuide& guide = now.patch.guide;
    const double scale = strength / (guide.radius * guide.radius);
    const Eigen::Matrix3d across =
        Eigen::Matrix3d::Identity() - guide.axis * guide.axis.transpose();
    parallelFor(guide.vertices.size(), kGuideGrain, [&](std::size_t n) {
      const std::int32_t i = unknown[guide.vertices[n]];
      const double curvature = pullOn(guide, n, now.x).curvature;
      if (i >= 0 && curvature > 0) {
        system.add(i, i, scale * guide.weights[n] * curvature * across);
      }
    });
  }
};

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

void makeOtherTerms(Terms& terms) {
  terms[static_cast<std::size_t>(Term::Spring)] = std::make_unique<SpringEnergy>();
  terms[static_cast<std::size_t>(Term::Guide)] = std::make_unique<GuideEnergy>();
  terms[static_cast<std::size_t>(Term::Contact)] = std::make_unique<ContactEnergy>();
  terms[static_cast<std::size_t>(Term::Knot)] = std::make_unique<KnotTerm>();
}

}  // namespace explica::unfolding
