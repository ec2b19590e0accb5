// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/SparseCholesky.h"

#include "Explica/Core/Parallel.h"

namespace explica::geometry {

void SparseCholesky::compute(const Eigen::SparseMatrix<double>& matrix) {
  using Entry = Eigen::SparseMatrix<double>::InnerIterator;
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  std::vector<double> below, diagonal;
  for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
    for (Entry entry(matrix, column); entry; ++entry) {
      const auto row = static_cast<std::int32_t>(entry.row());
      if (row == column) diagonal.push_back(entry.value());
      if (row <= column) continue;
      edges.emplace_back(row, static_cast<std::int32_t>(column));
      below.push_back(entry.value());
    }
  }
  Elimination elimination = eliminationOf(static_cast<std::int32_t>(matrix.rows()), edges);
  place_ = std::move(elimination.place);
  definite_ = diagonal.size() == place_.size();
  if (!definite_) return;
  std::vector<BlockCholesky<1>::Block> values(elimination.edge.size());
  for (std::size_t n = 0; n < values.size(); ++n) {
    const std::int32_t edge = elimination.edge[n];
    if (!below.empty()) values[n](0, 0) = below[std::max(edge, ~edge)];
  }
  for (std::size_t v = 0; v < place_.size(); ++v) {
    values[elimination.pattern.begin[place_[v]]](0, 0) = diagonal[v];
  }
  factor_.analyse(elimination.pattern);
  definite_ = factor_.factorise(elimination.pattern, values);
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
