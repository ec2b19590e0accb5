// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"
#include "Explica/Geometry/BlockCholesky.h"

#include <utility>
#include <vector>

namespace explica::unfolding {

/// Unordered pairs of unknowns that some term couples: first > second.
using Couplings = std::vector<std::pair<std::int32_t, std::int32_t>>;

/// Symmetric positive definite system of 3 x 3 blocks, one unknown point per row.
///
/// The fill-reducing ordering is found on the graph of points, a ninth of the work of ordering
/// scalars, and kept as long as the couplings stay the same.
class BlockSystem {
 public:
  /// Makes room for the couplings (any order, repetitions allowed) and sets all values to zero.
  void reset(std::int32_t pointCount, Couplings couplings);

  /// Adds `block` at (i, j), and with i != j its transpose at (j, i): call once per unordered pair.
  void add(std::int32_t i, std::int32_t j, const Eigen::Matrix3d& block);

  /// Adds to every diagonal entry.
  void addDiagonal(double value);

  /// Solves for N x 3 unknowns.
  /// @return false if the matrix is not positive definite to working precision
  [[nodiscard]] bool solve(const Positions& rightSide, Positions& solution);

  [[nodiscard]] const geometry::BlockCholesky<3>& factor() const { return factor_; }

 private:
  void layOut();

  std::int32_t count_ = 0;
  Couplings couplings_;
  std::vector<std::int32_t> place_;      ///< position of each point in the elimination order
  geometry::BlockPattern pattern_;                 ///< in elimination order
  std::vector<Eigen::Matrix3d> blocks_;  ///< of the pattern's entries; of diagonal ones the lower
                                         ///< triangle counts
  geometry::BlockCholesky<3> factor_;
};

}  // namespace explica::unfolding
