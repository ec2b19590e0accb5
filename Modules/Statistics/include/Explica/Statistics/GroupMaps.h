// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace explica::statistics {

/// Mean and deviation of people's maps at every place, gathered one person at a time
/// [Welford1962]; NaN is not counted.
class GroupMaps {
 public:
  explicit GroupMaps(Eigen::Index places);

  /// @param map  V values
  void add(const Eigen::VectorXd& map);

  [[nodiscard]] const Eigen::VectorXd& people() const { return count_; }  ///< V counts
  [[nodiscard]] Eigen::VectorXd mean() const;       ///< V; NaN where nobody is known
  [[nodiscard]] Eigen::VectorXd deviation() const;  ///< V, with n - 1; NaN of fewer than 2
  [[nodiscard]] Eigen::VectorXd variation() const;  ///< V, deviation over mean

  /// How far a person is from the others: z = (x - m) / (s sqrt(1 + 1/n)), m, s and n those of the
  /// group without the person, so that an outlier does not hide behind its own share.  Of normal
  /// values z is Student's t with n - 1 degrees of freedom.  NaN where fewer than 3 others are
  /// known, or do not differ.
  /// @param map     V values
  /// @param member  whether add() has been given this map
  [[nodiscard]] Eigen::VectorXd distance(const Eigen::VectorXd& map, bool member) const;

 private:
  Eigen::VectorXd count_, mean_, squares_;  ///< V; squares: of differences from the mean
};

/// A z-map as one number: the median of |z| over that of |t| with `others` - 1 degrees of freedom.
/// 1 is a person like the others; NaN where no z is known.
[[nodiscard]] double typicalDistance(const Eigen::VectorXd& z, Eigen::Index others);

}  // namespace explica::statistics
