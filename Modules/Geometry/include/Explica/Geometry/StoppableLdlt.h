// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/SparseCholesky>

namespace explica::geometry {

/// Eigen's factorisation L D L^T of a sparse symmetric matrix, of which the lower triangle is read,
/// with checkpoints of the caller's StopScope: for a surface of 164,000 vertices it takes seconds.
/// Numbers are those of Eigen::SimplicialLDLT, bit by bit.
class StoppableLdlt : public Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> {
 public:
  StoppableLdlt() = default;
  explicit StoppableLdlt(const Eigen::SparseMatrix<double>& matrix) { compute(matrix); }

  /// info() is not Success where a pivot is 0.
  /// @throws Interrupted  the monitor of the scope asks for an end
  void compute(const Eigen::SparseMatrix<double>& matrix);

 private:
  bool factoriseRows(const Eigen::SparseMatrix<double>& upper);
};

}  // namespace explica::geometry
