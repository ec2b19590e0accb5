// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "BlockSystem.h"

#include <Eigen/OrderingMethods>

#include <algorithm>

namespace explica::unfolding {

void BlockSystem::reset(std::int32_t pointCount, Couplings couplings) {
  std::sort(couplings.begin(), couplings.end());
  couplings.erase(std::unique(couplings.begin(), couplings.end()), couplings.end());
  if (pointCount != count_ || couplings != couplings_) {
    count_ = pointCount;
    couplings_ = std::move(couplings);
    layOut();
  }
  std::fill_n(matrix_.valuePtr(), matrix_.nonZeros(), 0.0);
}

void BlockSystem::layOut() {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(2 * couplings_.size() + count_);
  for (std::int32_t i = 0; i < count_; ++i) entries.emplace_back(i, i, 1.0);
  for (const auto& [i, j] : couplings_) {
    entries.emplace_back(i, j, 1.0);
    entries.emplace_back(j, i, 1.0);
  }
  Eigen::SparseMatrix<double> graph(count_, count_);
  graph.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(graph, order);
  place_.resize(static_cast<std::size_t>(count_));
  for (std::int32_t n = 0; n < count_; ++n) place_[order.indices()[n]] = n;

  std::vector<std::pair<std::int32_t, std::int32_t>> blocks;  // column, row
  blocks.reserve(couplings_.size() + place_.size());
  for (std::int32_t n = 0; n < count_; ++n) blocks.emplace_back(n, n);
  for (const auto& [i, j] : couplings_) {
    blocks.emplace_back(std::min(place_[i], place_[j]), std::max(place_[i], place_[j]));
  }
  std::sort(blocks.begin(), blocks.end());
  begin_.assign(static_cast<std::size_t>(count_) + 1, 0);
  rows_.resize(blocks.size());
  for (std::size_t n = 0; n < blocks.size(); ++n) {
    ++begin_[blocks[n].first + 1];
    rows_[n] = blocks[n].second;
  }
  for (std::int32_t n = 0; n < count_; ++n) begin_[n + 1] += begin_[n];

  std::vector<int> inner;
  inner.reserve(9 * blocks.size());
  std::vector<int> outer = {0};
  for (std::int32_t column = 0; column < count_; ++column) {
    for (int k = 0; k < 3; ++k) {
      for (int r = k; r < 3; ++r) inner.push_back(3 * column + r);
      for (std::int32_t n = begin_[column] + 1; n < begin_[column + 1]; ++n) {
        for (int r = 0; r < 3; ++r) inner.push_back(3 * rows_[n] + r);
      }
      outer.push_back(static_cast<int>(inner.size()));
    }
  }
  std::vector<double> values(inner.size(), 0.0);
  matrix_ = Eigen::Map<const Eigen::SparseMatrix<double>>(
      3 * count_, 3 * count_, static_cast<Eigen::Index>(inner.size()), outer.data(), inner.data(),
      values.data());
  analysed_ = false;
}

void BlockSystem::add(std::int32_t i, std::int32_t j, const Eigen::Matrix3d& block) {
  const std::int32_t column = std::min(place_[i], place_[j]);
  const std::int32_t row = std::max(place_[i], place_[j]);
  double* values = matrix_.valuePtr();
  const int* outer = matrix_.outerIndexPtr() + 3 * column;
  if (row == column) {
    for (int k = 0; k < 3; ++k) {
      for (int r = k; r < 3; ++r) values[outer[k] + r - k] += block(r, k);
    }
    return;
  }
  const auto first = rows_.begin() + begin_[column];
  const auto found = std::lower_bound(first + 1, rows_.begin() + begin_[column + 1], row);
  const int offset = 3 * static_cast<int>(found - first - 1);
  const bool flipped = place_[i] != row;  // stored block is (row, column)
  for (int k = 0; k < 3; ++k) {
    double* at = values + outer[k] + (3 - k) + offset;
    for (int r = 0; r < 3; ++r) at[r] += flipped ? block(k, r) : block(r, k);
  }
}

void BlockSystem::addDiagonal(double value) {
  double* values = matrix_.valuePtr();
  const int* outer = matrix_.outerIndexPtr();
  for (std::int32_t n = 0; n < 3 * count_; ++n) values[outer[n]] += value;
}

bool BlockSystem::solve(const Positions& rightSide, Positions& solution) {
  if (!analysed_) {
    factor_.analyzePattern(matrix_);
    analysed_ = true;
  }
  factor_.factorize(matrix_);
  if (factor_.info() != Eigen::Success) return false;
  factorNonZeros_ = factor_.matrixL().nestedExpression().nonZeros();
  Eigen::VectorXd ordered(3 * count_);
  for (std::int32_t i = 0; i < count_; ++i) {
    ordered.segment<3>(3 * place_[i]) = rightSide.row(i).transpose();
  }
  const Eigen::VectorXd found = factor_.solve(ordered);
  solution.resize(count_, 3);
  for (std::int32_t i = 0; i < count_; ++i) {
    solution.row(i) = found.segment<3>(3 * place_[i]).transpose();
  }
  return solution.allFinite();
}

}  // namespace explica::unfolding
