// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/BlockCholesky.h"

#include <Eigen/SparseCore>

namespace explica::geometry {

/// Cholesky factorisation of a sparse symmetric positive definite matrix of numbers, for many right
/// sides: BlockCholesky with an order of its own.  Of the matrix the lower triangle is read.
class SparseCholesky {
 public:
  SparseCholesky() = default;
  explicit SparseCholesky(const Eigen::SparseMatrix<double>& matrix) { compute(matrix); }

  void compute(const Eigen::SparseMatrix<double>& matrix);

  /// False if the matrix is not positive definite to working precision: nothing can be solved.
  [[nodiscard]] bool isDefinite() const { return definite_; }
  [[nodiscard]] Eigen::Index rows() const { return static_cast<Eigen::Index>(place_.size()); }

  /// @param right  N x any number of columns
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& right) const;

 private:
  std::vector<std::int32_t> place_;  ///< of each unknown in the elimination order
  BlockCholesky<1> factor_;
  bool definite_ = false;
};

}  // namespace explica::geometry
