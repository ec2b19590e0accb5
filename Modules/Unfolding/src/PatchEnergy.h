// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "BlockSystem.h"

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Visibility/Viewpoints.h"

#include <array>
#include <vector>

namespace explica::unfolding {

/// A face whose area is kept and, in the region, whose normal is turned to the viewpoint.
struct PatchFace {
  std::array<std::int32_t, 3> vertices;
  double restArea = 0;  ///< mm^2
  double weight = 0;    ///< mm^2: the rest area, less for needles
  bool looked = true;   ///< the visibility term acts
};

/// An edge that keeps its length elastically.
struct PatchSpring {
  std::array<std::int32_t, 2> vertices;
  double restLength = 0;  ///< mm
  double weight = 0;      ///< mm^2: two thirds of the mean face, less for the shortest edges
  bool looked = true;     ///< of a face in the region, not of its collar alone
};

/// Room for the patch laid flat: the height along `axis` above which no surroundings stand within
/// its radius.
struct PatchRoom {
  Vector axis = Vector::UnitZ();  ///< unit, towards the viewpoints
  double height = -kInfinity;     ///< mm, of x . axis
  double radius = 1;              ///< mm, of a disc of the patch's area
};

/// Strengths of the terms; the visibility term has strength 1.
struct PatchStrengths {
  double visibility = 1;
  double area = 1;
  double spring = 1;
  double lift = 0;
};

/// Terms of the objective, mm^2.
struct PatchValue {
  double visibility = 0;  ///< sum of w (1 - n . d), d the mean direction to the viewpoints
  double area = 0;        ///< sum of w (multiplier c + area/2 c^2), c = A / A0 - 1
  double spring = 0;      ///< sum of w spring (l / l0 - 1)^2
  double lift = 0;  ///< sum of w lift/2 (deficit / radius)^2, deficit = max(0, height - x . axis)
  [[nodiscard]] double total() const { return visibility + area + spring + lift; }
};

/// What the patch wants regardless of contacts: to be seen, to keep areas, to keep lengths.
///
/// With areas kept, sum of A0 (1 - n . d) is the total area times one less the average visibility
/// [Thesis, Eq. 5.26]; off that constraint it differs: every face feels a torque towards the
/// viewpoint, where the flux itself pulls at the rim only, and no face gains by growing.
class PatchEnergy {
 public:
  PatchEnergy() = default;
  PatchEnergy(std::vector<PatchFace> faces, std::vector<PatchSpring> springs)
      : faces_(std::move(faces)), springs_(std::move(springs)) {}

  [[nodiscard]] PatchValue value(const Positions& x, const visibility::Viewpoints& viewpoints,
                                 const PatchStrengths& strengths,
                                 const Eigen::VectorXd& multipliers) const;

  /// Adds the gradient by each vertex into `gradient` (V x 3).
  void addGradient(const Positions& x, const visibility::Viewpoints& viewpoints,
                   const PatchStrengths& strengths, const Eigen::VectorXd& multipliers,
                   Positions& gradient) const;

  /// Adds a positive semi-definite part of the Hessian: Gauss-Newton for all terms, and the
  /// stiffness of tension across the surface.
  /// @param unknown  V: row in the system, -1 for vertices that stay
  void addStiffness(const Positions& x, const PatchStrengths& strengths,
                    const Eigen::VectorXd& multipliers, const std::vector<std::int32_t>& unknown,
                    BlockSystem& system) const;

  void setRoom(const PatchRoom& room) { room_ = room; }

  [[nodiscard]] const std::vector<PatchFace>& faces() const { return faces_; }
  [[nodiscard]] const std::vector<PatchSpring>& springs() const { return springs_; }

 private:
  std::vector<PatchFace> faces_;
  std::vector<PatchSpring> springs_;
  PatchRoom room_;
};

}  // namespace explica::unfolding
