// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "../Patch.h"

#include "Explica/Collision/ContactPotential.h"
#include "Explica/Repulsion/KnotEnergy.h"
#include "Explica/Unfolding/Unfolder.h"
#include "Explica/Visibility/Viewpoints.h"

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace explica::unfolding {

/// A state of the surface and what terms need to know of it, found once for all of them.
class Configuration {
 public:
  /// Keeps references to all arguments.
  Configuration(const Patch& whose, const Positions& where, const visibility::Viewpoints& seenFrom,
                const Eigen::VectorXd& areaMultipliers, std::span<const collision::Contact> near,
                const repulsion::KnotEnergy* repulsion);

  const Patch& patch;
  const Positions& x;  ///< V x 3
  const visibility::Viewpoints& viewpoints;
  const Eigen::VectorXd& multipliers;            ///< one per face of the region
  std::span<const collision::Contact> contacts;  ///< a superset of the pairs within range
  const repulsion::KnotEnergy* knot;             ///< null without one
  /// Where faces of the region are to look, R x 3; null: towards the viewpoints.
  const Positions* directions = nullptr;
  std::vector<FaceShape> shapes;  ///< of the patch's faces

  /// Derivatives of the contact barrier, found at the first call.
  [[nodiscard]] const std::vector<collision::ContactForce>& contactForces() const;

 private:
  mutable std::optional<std::vector<collision::ContactForce>> forces_;
};

/// One term of the objective: the formula stands in its file.  `strength` is the term's weight
/// times what the iterations make of it (see Objective).
class Energy {
 public:
  virtual ~Energy() = default;

  [[nodiscard]] virtual double value(const Configuration& now, double strength) const = 0;

  /// Adds the gradient by each vertex into `gradient` (V x 3).
  virtual void addGradient(const Configuration& now, double strength,
                           Positions& gradient) const = 0;

  /// Adds a positive semi-definite part of the Hessian; nothing for a term that steps take as
  /// linear.
  /// @param unknown  V: row in the system, -1 for vertices that stay
  virtual void addStiffness(const Configuration& now, double strength,
                            const std::vector<std::int32_t>& unknown, BlockSystem& system) const;

  /// Which time of the account is spent here.
  [[nodiscard]] virtual double PhaseSeconds::*phase() const { return &PhaseSeconds::visibility; }
};

/// One for each row of kTerms, at the same place.
using Terms = std::array<std::unique_ptr<Energy>, kTermCount>;
void makeFaceTerms(Terms& terms);   ///< sums over faces
void makeOtherTerms(Terms& terms);  ///< of edges, vertices and pairs

/// The sum of all terms.
class Objective {
 public:
  Objective();

  /// @param account  gets the value of every term, and the time spent
  /// @return their sum, mm^2
  double value(const Configuration& now, const TermValues& strengths,
               IterationRecord& account) const;
  /// V x 3.
  [[nodiscard]] Positions gradient(const Configuration& now, const TermValues& strengths,
                                   IterationRecord& account) const;
  /// Adds a positive semi-definite part of the Hessian.
  void addStiffness(const Configuration& now, const TermValues& strengths,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const;

 private:
  Terms terms_;
};

/// Of a radius: a pull to a height or a place grows with the way there as far as this, and no more,
/// so that nothing is dragged through the rest before that has made way.
inline constexpr double kFirm = 0.03;

// What springs contribute: a part of two terms, strength * sum of e r(l / l0 - 1), with
// r(s) = 2 s^2 / (1 + sqrt(1 + (s / d)^2)), d the strain of yielding: s^2 for strains far below d,
// 2 d |s| far above, so that a few edges may give way where a surface cannot be laid flat
// otherwise.
[[nodiscard]] double springValue(std::span<const PatchSpring> springs, double yield,
                                 const Positions& x, double strength);
void addSpringGradient(std::span<const PatchSpring> springs, double yield, const Positions& x,
                       double strength, Positions& gradient);
/// Of `count` of the patch's springs from `first` on.
void addSpringStiffness(const Patch& patch, std::size_t first, std::size_t count,
                        const Positions& x, double strength,
                        const std::vector<std::int32_t>& unknown, BlockSystem& system);

}  // namespace explica::unfolding
