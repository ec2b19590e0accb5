// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "BlockSystem.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <numeric>

namespace explica::unfolding {
namespace {

constexpr std::size_t kGrain = 512;  // elements a task

}  // namespace

BlockSystem::Rows BlockSystem::rowsOf(std::int32_t pointCount, const Couplings& couplings) {
  std::vector<std::int32_t> begin(static_cast<std::size_t>(pointCount) + 1, 0);
  for (const auto& [i, j] : couplings) ++begin[i + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::int32_t> columns(couplings.size());
  std::vector<std::int32_t> end(begin.begin(), begin.end() - 1);
  for (const auto& [i, j] : couplings) columns[end[i]++] = j;
  parallelFor(static_cast<std::size_t>(pointCount), kGrain, [&](std::size_t i) {
    const auto first = columns.begin() + begin[i];
    std::sort(first, columns.begin() + end[i]);
    end[i] =
        static_cast<std::int32_t>(std::unique(first, columns.begin() + end[i]) - columns.begin());
  });
  Rows rows;
  rows.begin.resize(begin.size());
  rows.columns.reserve(columns.size());
  for (std::int32_t i = 0; i < pointCount; ++i) {
    rows.begin[i] = static_cast<std::int32_t>(rows.columns.size());
    rows.columns.insert(rows.columns.end(), columns.begin() + begin[i], columns.begin() + end[i]);
  }
  rows.begin[pointCount] = static_cast<std::int32_t>(rows.columns.size());
  return rows;
}

void BlockSystem::reset(std::int32_t pointCount, const Couplings& couplings) {
  Rows rows = rowsOf(pointCount, couplings);
  if (pointCount != count_ || rows != rows_) {
    count_ = pointCount;
    rows_ = std::move(rows);
    ordered_ = false;
  }
  diagonal_.assign(static_cast<std::size_t>(count_), Eigen::Matrix3d::Zero());
  below_.assign(rows_.columns.size(), Eigen::Matrix3d::Zero());
}

void BlockSystem::order() {
  if (ordered_) return;
  Couplings couplings;
  couplings.reserve(rows_.columns.size());
  for (std::int32_t i = 0; i < count_; ++i) {
    for (std::int32_t n = rows_.begin[i]; n < rows_.begin[i + 1]; ++n) {
      couplings.emplace_back(i, rows_.columns[n]);
    }
  }
  elimination_ = geometry::eliminationOf(count_, couplings);
  blocks_.resize(elimination_.edge.size());
  factor_.analyse(elimination_.pattern);
  ordered_ = true;
}

void BlockSystem::addDiagonal(double value) {
  for (Eigen::Matrix3d& block : diagonal_) block.diagonal().array() += value;
}

bool BlockSystem::solve(const Positions& rightSide, Positions& solution) {
  order();
  const std::vector<std::int32_t>&place = elimination_.place, &edge = elimination_.edge;
  const geometry::BlockPattern& pattern = elimination_.pattern;
  parallelFor(static_cast<std::size_t>(count_), kGrain, [&](std::size_t i) {
    const std::int32_t column = place[i];
    blocks_[pattern.begin[column]] = diagonal_[i];
    for (std::int32_t e = pattern.begin[column] + 1; e < pattern.begin[column + 1]; ++e) {
      if (edge[e] >= 0) {
        blocks_[e] = below_[edge[e]];
      } else {
        blocks_[e] = below_[~edge[e]].transpose();
      }
    }
  });
  if (!factor_.factorise(pattern, blocks_)) return false;
  Eigen::VectorXd ordered(3 * count_);
  for (std::int32_t i = 0; i < count_; ++i) {
    ordered.segment<3>(3 * place[i]) = rightSide.row(i).transpose();
  }
  factor_.solve(ordered);
  solution.resize(count_, 3);
  for (std::int32_t i = 0; i < count_; ++i) {
    solution.row(i) = ordered.segment<3>(3 * place[i]).transpose();
  }
  return solution.allFinite();
}

}  // namespace explica::unfolding
