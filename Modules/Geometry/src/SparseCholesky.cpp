// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/SparseCholesky.h"

#include "Explica/Core/Parallel.h"

namespace explica::geometry {
namespace {

/// The lower triangle in the order of the places; rows of a column ascending.
Eigen::SparseMatrix<double> inOrder(const Eigen::SparseMatrix<double>& matrix,
                                    const std::vector<std::int32_t>& place) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, std::int32_t> order(matrix.rows());
  std::ranges::copy(place, order.indices().begin());
  Eigen::SparseMatrix<double> lower(matrix.rows(), matrix.cols());
  lower.selfadjointView<Eigen::Lower>() = matrix.selfadjointView<Eigen::Lower>().twistedBy(order);
  const Eigen::SparseMatrix<double, Eigen::RowMajor> byRows = lower;  // which sorts
  return byRows;
}

}  // namespace

void SparseCholesky::compute(const Eigen::SparseMatrix<double>& matrix) {
  using Entry = Eigen::SparseMatrix<double>::InnerIterator;
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  std::int32_t diagonal = 0;  // entries
  for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
    for (Entry entry(matrix, column); entry; ++entry) {
      const auto row = static_cast<std::int32_t>(entry.row());
      if (row > column) edges.emplace_back(row, static_cast<std::int32_t>(column));
      diagonal += row == column;
    }
  }
  place_ = eliminationPlaces(static_cast<std::int32_t>(matrix.rows()), edges);
  definite_ = diagonal == matrix.rows();
  if (!definite_) return;
  const Eigen::SparseMatrix<double> lower = inOrder(matrix, place_);
  BlockPattern pattern;
  pattern.begin.assign(lower.outerIndexPtr(), lower.outerIndexPtr() + lower.cols() + 1);
  pattern.rows.assign(lower.innerIndexPtr(), lower.innerIndexPtr() + lower.nonZeros());
  std::vector<BlockCholesky<1>::Block> values(pattern.rows.size());
  for (std::size_t n = 0; n < values.size(); ++n) values[n](0, 0) = lower.valuePtr()[n];
  factor_.analyse(pattern);
  definite_ = factor_.factorise(pattern, values);
}

Eigen::MatrixXd SparseCholesky::solve(const Eigen::Ref<const Eigen::MatrixXd>& right) const {
  Eigen::MatrixXd solution(right.rows(), right.cols());
  parallelFor(static_cast<std::size_t>(right.cols()), 1, [&](std::size_t n) {
    const auto column = static_cast<Eigen::Index>(n);
    Eigen::VectorXd ordered(right.rows());
    for (Eigen::Index v = 0; v < right.rows(); ++v) ordered[place_[v]] = right(v, column);
    factor_.solve(ordered);
    for (Eigen::Index v = 0; v < right.rows(); ++v) solution(v, column) = ordered[place_[v]];
  });
  return solution;
}

}  // namespace explica::geometry
