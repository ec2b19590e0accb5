// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Ventricle/Slices.h"

#include <array>
#include <vector>

namespace explica::ventricle {

/// How a boundary of the wall goes on from slice to slice, and how far it is.
///
/// In slice k the boundary is c(z) + rho(theta, z) e(theta) about the centroid c of what it
/// encloses.  For an ellipsoid cut by any planes c is linear and rho^2 quadratic in z; so between
/// slices c and rho^2 are the parabolas through three of them: the slice and its neighbours, at the
/// ends of the stack the three last ones.
class BoundaryProfile {
 public:
  /// @param enclosed  true for the labels that the boundary encloses
  /// @param usable    per slice: the boundary there can be believed
  /// @param shift     per slice: how far it was moved within its plane, mm; points are given
  /// without
  template <class Enclosed>
  BoundaryProfile(const Volume<Label>& heart, const std::vector<bool>& usable,
                  const std::vector<Eigen::Vector2d>& shift, Enclosed enclosed);

  /// Distance of a place within slice k from the boundary, in the plane that the slice's normal
  /// spans with a direction.
  /// @param k       where it is not usable, the nearest slice's parabola is continued to it
  /// @param point   of the boundary in slice k, mm along i and j, less the slice's shift
  /// @param normal  unit, within the slice, outward
  /// @param gap     of `point` from the place along `normal`, mm, signed
  /// @return mm; |gap| if fewer than two slices are usable
  [[nodiscard]] double distance(int k, const Eigen::Vector2d& point, const Eigen::Vector2d& normal,
                                double gap) const;

 private:
  static constexpr int kAngles = 96;
  struct Shape {
    bool usable = false;
    Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< mm
    std::array<double, kAngles> squared = {};          ///< rho^2, mm^2
  };
  /// value + slope z + bend z^2, z in slices.
  template <class Value>
  struct Parabola {
    Value value, slope, bend;
    [[nodiscard]] Value at(double z) const { return Value(value + z * (slope + z * bend)); }
  };
  using Mask = std::vector<float>;

  [[nodiscard]] bool has(int k) const {
    return k >= 0 && k < static_cast<int>(shapes_.size()) && shapes_[k].usable;
  }
  [[nodiscard]] int nearestTo(int k) const;
  [[nodiscard]] Shape shapeOf(const Mask& mask, const std::array<int, 3>& size) const;
  template <class Value, class ValueAt>
  [[nodiscard]] Parabola<Value> parabola(int k, const ValueAt& valueAt) const;

  Eigen::Vector2d pixel_;
  double slice_;
  std::vector<Shape> shapes_;
};

template <class Enclosed>
BoundaryProfile::BoundaryProfile(const Volume<Label>& heart, const std::vector<bool>& usable,
                                 const std::vector<Eigen::Vector2d>& shift, Enclosed enclosed)
    : pixel_(heart.grid.spacing.head<2>()),
      slice_(heart.grid.spacing[2]),
      shapes_(static_cast<std::size_t>(heart.grid.size[2])) {
  const auto& size = heart.grid.size;
  const std::size_t pixels = static_cast<std::size_t>(size[0]) * size[1];
  for (std::size_t k = 0; k < shapes_.size(); ++k) {
    if (!usable[k]) continue;
    Mask mask(pixels);
    for (std::size_t p = 0; p < pixels; ++p) mask[p] = enclosed(heart[k * pixels + p]) ? 1 : 0;
    shapes_[k] = shapeOf(mask, size);
    shapes_[k].centre -= shift[k];
  }
}

}  // namespace explica::ventricle
