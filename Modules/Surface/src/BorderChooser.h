// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/MeshTopology.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace explica::surface {

/// Places that are looked at on each side of where a border was.
inline constexpr int kSide = 10;
inline constexpr int kPlaces = 2 * kSide + 1;

/// How far brightness is from the border's level at each place, in contrasts: positive inside; NaN
/// off the image.
using Profile = std::array<float, kPlaces>;

/// What a vertex may choose between, first and last place.
struct Choice {
  int first = kSide, last = kSide;
};

/// What a place costs beside the squared miss of the level, which counts as one at most.
struct ChoiceCosts {
  double centring = 0;    ///< per squared length from where the border was
  double smoothness = 0;  ///< per squared length from the neighbours' mean
};

/// Each vertex's best place given its neighbours', over and over.
class BorderChooser {
 public:
  /// @param step    from place to place, mm
  /// @param length  in which costs count, mm
  BorderChooser(std::vector<Profile> misses, std::vector<Choice> choices,
                const geometry::MeshTopology& topology, double step, double length,
                const ChoiceCosts& costs);

  /// Per vertex, mm outward from where the border was; 0 where the level is not met.
  [[nodiscard]] Eigen::VectorXd choose(int rounds) const;

  /// Standard deviation of each chosen place, mm: noise, and what is left of the level, over the
  /// slope of the profiles around; `most` at most, and where the level is not met.
  /// @param noise  of brightness along the profiles, in contrasts
  [[nodiscard]] Eigen::VectorXd deviations(const Eigen::VectorXd& chosen,
                                           const Eigen::VectorXd& noise, double most) const;

  /// Per vertex, 1 where brightness comes nowhere near the level, else 0.
  [[nodiscard]] Eigen::VectorXd missing() const;

 private:
  [[nodiscard]] bool comesNear(std::size_t v) const;
  [[nodiscard]] double bestOf(std::size_t v, double mean) const;

  std::vector<Profile> misses_;
  std::vector<Choice> choices_;
  const geometry::MeshTopology& topology_;
  double step_, length_;
  std::array<double, kPlaces> ways_;  ///< from the middle to each place, of `length`
  ChoiceCosts costs_;
  std::vector<std::uint8_t> has_;
};

}  // namespace explica::surface
