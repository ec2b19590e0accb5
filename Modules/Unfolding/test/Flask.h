// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Testing/Meshes.h"

#include <cmath>
#include <vector>

namespace explica::unfolding {

/// A sheet with a pit in its middle, folded at the bottom, whose mouth is narrower than that, as
/// the opercula leave it above the insula: seen from +z.  Squares about the middle become rings.
struct Flask {
  static constexpr int kHalf = 20;    ///< grid steps from the middle to the rim
  static constexpr int kBottom = 6;   ///< steps to the end of the flat bottom
  static constexpr double kStep = 1;  ///< mm
  static constexpr double kFold = 1;  ///< mm: the bottom's folds, up and down

  TriangleMesh mesh = geometry::makeRectangle(2 * kHalf, 2 * kHalf, 2 * kHalf, 2 * kHalf);
  std::vector<bool> bottom;  ///< vertices of the pit's bottom

  /// @param wall  steps along the wall
  /// @param lean  its slope towards the middle, mm per mm of height
  explicit Flask(double wall = 6, double lean = 0.15) {
    bottom.resize(static_cast<std::size_t>(mesh.vertexCount()));
    for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
      const double x = mesh.positions(v, 0) - kHalf, y = mesh.positions(v, 1) - kHalf;
      const double ring = std::max(std::abs(x), std::abs(y));
      bottom[v] = ring <= kBottom;
      const Eigen::Vector2d profile = profileAt(ring, wall, lean);
      const double angle = std::atan2(y, x);
      const double fold = ring < kBottom ? kFold * std::cos(0.5 * kPi * x) : 0;
      mesh.positions.row(v) << profile[0] * std::cos(angle), profile[0] * std::sin(angle),
          profile[1] + fold;
    }
  }

  /// Radius and height of a ring.
  static Eigen::Vector2d profileAt(double ring, double wall, double lean) {
    const double rise = kStep / std::hypot(1.0, lean);
    const double onWall = std::clamp(ring - kBottom, 0.0, wall);
    const double outside = std::max(0.0, ring - kBottom - wall);
    return {std::min<double>(ring, kBottom) - lean * rise * onWall + outside, rise * onWall};
  }
};

}  // namespace explica::unfolding
