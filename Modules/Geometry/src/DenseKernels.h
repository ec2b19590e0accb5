// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

/// Dense steps of a Cholesky factorisation, for the machine's widest vectors, chosen at run time.
///
/// Matrices stand column by column. Every entry takes its products one after the other and without
/// fused multiply-add, so that all instruction sets give the same bits.
namespace explica::geometry::kernels {

inline constexpr std::ptrdiff_t kMostColumns = 24;  ///< that are eliminated at a time

/// A part of a matrix.
struct DenseBlock {
  double* data;
  std::ptrdiff_t rows, columns;
  std::ptrdiff_t stride;  ///< from column to column
  [[nodiscard]] double* at(std::ptrdiff_t row, std::ptrdiff_t column) const {
    return data + row + column * stride;
  }
};

/// Replaces the lower triangle of a block of at most kMostColumns columns by its Cholesky factor.
/// @return false if it is not positive definite to working precision
[[nodiscard]] bool factoriseCorner(const DenseBlock& corner);

/// below := below * corner^-T for a factor in the lower triangle of `corner`.
void solveBelow(const DenseBlock& corner, const DenseBlock& below);

/// target -= left * right^T, for entries (i, j) with j <= i + below; the others are left undefined.
/// @param left   target.rows x depth
/// @param right  target.columns x depth
/// @param below  rows by which the target's first one lies below the row of its first diagonal
/// entry
void subtractProduct(const DenseBlock& left, const DenseBlock& right, const DenseBlock& target,
                     std::ptrdiff_t below = 0);

}  // namespace explica::geometry::kernels
