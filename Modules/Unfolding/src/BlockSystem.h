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
/// Blocks are added in the order of the unknowns, where neighbours stand near each other, and go to
/// their places in the elimination order when the system is solved.  That order is found on the
/// graph of points, a ninth of the work of ordering scalars, and kept as long as the couplings stay
/// the same.
class BlockSystem {
 public:
  /// Makes room for the couplings (any order, repetitions allowed) and sets all values to zero.
  void reset(std::int32_t pointCount, const Couplings& couplings);

  /// Finds the elimination order, unless it is known: values may be added meanwhile.
  void order();

  /// Adds `block` at (i, j), and with i != j its transpose at (j, i): call once per unordered pair.
  void add(std::int32_t i, std::int32_t j, const Eigen::Matrix3d& block) {
    if (i == j) {
      diagonal_[i] += block;
    } else if (i > j) {
      below_[placeOf(i, j)] += block;
    } else {
      below_[placeOf(j, i)] += block.transpose();
    }
  }

  /// Adds to every diagonal entry.
  void addDiagonal(double value);

  /// Solves for N x 3 unknowns.
  /// @return false if the matrix is not positive definite to working precision
  [[nodiscard]] bool solve(const Positions& rightSide, Positions& solution);

  [[nodiscard]] const geometry::BlockCholesky<3>& factor() const { return factor_; }

 private:
  /// Couplings of each unknown with those before it, ascending.
  struct Rows {
    std::vector<std::int32_t> begin, columns;
    bool operator==(const Rows&) const = default;
  };
  static Rows rowsOf(std::int32_t pointCount, const Couplings& couplings);
  /// Rows are short: a walk along one is faster than halving it.
  [[nodiscard]] std::size_t placeOf(std::int32_t row, std::int32_t column) const {
    std::int32_t n = rows_.begin[row];
    while (rows_.columns[n] != column) ++n;
    return static_cast<std::size_t>(n);
  }

  std::int32_t count_ = 0;
  Rows rows_;
  bool ordered_ = false;                   ///< the elimination is that of rows_
  std::vector<Eigen::Matrix3d> diagonal_;  ///< of each unknown
  std::vector<Eigen::Matrix3d> below_;     ///< of each of rows_.columns
  geometry::Elimination elimination_;
  std::vector<Eigen::Matrix3d> blocks_;  ///< of the pattern's entries
  geometry::BlockCholesky<3> factor_;
};

}  // namespace explica::unfolding
