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
  place_ = geometry::eliminationPlaces(count_, couplings);
  layOut(couplings);
  ordered_ = true;
}

void BlockSystem::layOut(const Couplings& couplings) {
  pattern_.begin.assign(static_cast<std::size_t>(count_) + 1, 0);
  for (std::int32_t n = 0; n < count_; ++n) pattern_.begin[n + 1] = 1;
  for (const auto& [i, j] : couplings) ++pattern_.begin[std::min(place_[i], place_[j]) + 1];
  std::partial_sum(pattern_.begin.begin(), pattern_.begin.end(), pattern_.begin.begin());
  struct Entry {
    std::int32_t row, source;
  };
  std::vector<Entry> entries(static_cast<std::size_t>(pattern_.begin[count_]));
  std::vector<std::int32_t> at(pattern_.begin.begin(), pattern_.begin.end() - 1);
  for (std::int32_t n = 0; n < count_; ++n) entries[at[n]++] = {n, 0};
  for (std::size_t n = 0; n < couplings.size(); ++n) {
    const std::int32_t i = place_[couplings[n].first], j = place_[couplings[n].second];
    const auto source = static_cast<std::int32_t>(n);
    entries[at[std::min(i, j)]++] = {std::max(i, j), i > j ? source : ~source};
  }
  pattern_.rows.resize(entries.size());
  source_.resize(entries.size());
  parallelFor(static_cast<std::size_t>(count_), kGrain, [&](std::size_t c) {
    std::sort(entries.begin() + pattern_.begin[c], entries.begin() + pattern_.begin[c + 1],
              [](const Entry& a, const Entry& b) { return a.row < b.row; });
    for (std::int32_t e = pattern_.begin[c]; e < pattern_.begin[c + 1]; ++e) {
      pattern_.rows[e] = entries[e].row;
      source_[e] = entries[e].source;
    }
  });
  blocks_.resize(entries.size());
  factor_.analyse(pattern_);
}

void BlockSystem::addDiagonal(double value) {
  for (Eigen::Matrix3d& block : diagonal_) block.diagonal().array() += value;
}

bool BlockSystem::solve(const Positions& rightSide, Positions& solution) {
  order();
  parallelFor(static_cast<std::size_t>(count_), kGrain, [&](std::size_t i) {
    const std::int32_t column = place_[i];
    blocks_[pattern_.begin[column]] = diagonal_[i];
    for (std::int32_t e = pattern_.begin[column] + 1; e < pattern_.begin[column + 1]; ++e) {
      if (source_[e] >= 0) {
        blocks_[e] = below_[source_[e]];
      } else {
        blocks_[e] = below_[~source_[e]].transpose();
      }
    }
  });
  if (!factor_.factorise(pattern_, blocks_)) return false;
  Eigen::VectorXd ordered(3 * count_);
  for (std::int32_t i = 0; i < count_; ++i) {
    ordered.segment<3>(3 * place_[i]) = rightSide.row(i).transpose();
  }
  factor_.solve(ordered);
  solution.resize(count_, 3);
  for (std::int32_t i = 0; i < count_; ++i) {
    solution.row(i) = ordered.segment<3>(3 * place_[i]).transpose();
  }
  return solution.allFinite();
}

}  // namespace explica::unfolding
