// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "BlockSystem.h"

#include <algorithm>
#include <numeric>

namespace explica::unfolding {

void BlockSystem::reset(std::int32_t pointCount, Couplings couplings) {
  std::sort(couplings.begin(), couplings.end());
  couplings.erase(std::unique(couplings.begin(), couplings.end()), couplings.end());
  if (pointCount != count_ || couplings != couplings_) {
    count_ = pointCount;
    couplings_ = std::move(couplings);
    layOut();
  }
  std::fill(blocks_.begin(), blocks_.end(), Eigen::Matrix3d::Zero());
}

void BlockSystem::layOut() {
  place_ = geometry::eliminationPlaces(count_, couplings_);
  pattern_.begin.assign(static_cast<std::size_t>(count_) + 1, 0);
  for (std::int32_t n = 0; n < count_; ++n) pattern_.begin[n + 1] = 1;
  for (const auto& [i, j] : couplings_) ++pattern_.begin[std::min(place_[i], place_[j]) + 1];
  std::partial_sum(pattern_.begin.begin(), pattern_.begin.end(), pattern_.begin.begin());
  pattern_.rows.resize(static_cast<std::size_t>(pattern_.begin[count_]));
  std::vector<std::int32_t> at(pattern_.begin.begin(), pattern_.begin.end() - 1);
  for (std::int32_t n = 0; n < count_; ++n) pattern_.rows[at[n]++] = n;
  for (const auto& [i, j] : couplings_) {
    pattern_.rows[at[std::min(place_[i], place_[j])]++] = std::max(place_[i], place_[j]);
  }
  for (std::int32_t n = 0; n < count_; ++n) {
    std::sort(pattern_.rows.begin() + pattern_.begin[n],
              pattern_.rows.begin() + pattern_.begin[n + 1]);
  }
  blocks_.resize(pattern_.rows.size());
  factor_.analyse(pattern_);
}

void BlockSystem::add(std::int32_t i, std::int32_t j, const Eigen::Matrix3d& block) {
  const std::int32_t column = std::min(place_[i], place_[j]);
  const std::int32_t row = std::max(place_[i], place_[j]);
  const auto first = pattern_.rows.begin() + pattern_.begin[column];
  const auto found =
      std::lower_bound(first, pattern_.rows.begin() + pattern_.begin[column + 1], row);
  Eigen::Matrix3d& at = blocks_[static_cast<std::size_t>(found - pattern_.rows.begin())];
  if (place_[i] == row) {
    at += block;
  } else {
    at += block.transpose();
  }
}

void BlockSystem::addDiagonal(double value) {
  for (std::int32_t n = 0; n < count_; ++n) {
    blocks_[pattern_.begin[n]].diagonal().array() += value;
  }
}

bool BlockSystem::solve(const Positions& rightSide, Positions& solution) {
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
