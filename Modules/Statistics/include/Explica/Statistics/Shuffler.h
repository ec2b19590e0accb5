// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace explica::statistics {

/// What is exchangeable where there is no effect.
enum class Exchange {
  Auto,    ///< signs if the tested regressor is the same for all; else whole blocks if it does not
           ///< vary within them; else people within blocks
  Within,  ///< people, within their block
  Whole,   ///< whole blocks of one size
  Signs    ///< the sign of each person's, or each block's, residuals: they are symmetric about 0
};
constexpr auto enumWords(Exchange) {
  using enum Exchange;
  return std::to_array<EnumWord<Exchange>>(
      {{Auto, "auto"}, {Within, "within"}, {Whole, "whole"}, {Signs, "signs"}});
}

/// The shuffles of people that leave a model without effect as likely as it was.
///
/// Number 0 leaves all in place.  Where no more shuffles exist than were asked for, each is made
/// once; otherwise they are drawn at random, each by its own number and the seed alone.
class Shuffler {
 public:
  /// @param blocks  N, from 0; empty: everybody is one block (of its own, for signs)
  /// @param exchange  not Auto
  /// @param count  wanted beside number 0
  Shuffler(Eigen::Index people, const std::vector<int>& blocks, Exchange exchange,
           std::int64_t count, std::uint64_t seed);

  [[nodiscard]] std::int64_t count() const { return count_; }  ///< with number 0
  [[nodiscard]] bool exhaustive() const { return exhaustive_; }

  /// Who takes each person's place, and with which sign.
  void draw(std::int64_t number, std::span<std::int32_t> order, std::span<float> signs) const;

  /// N x m, orthonormal: indicators of the sets of people who can take each other's place; vectors
  /// in their span are left as they are by every shuffle.  Of signs: no column.
  [[nodiscard]] Eigen::MatrixXd invariant() const;

 private:
  using Unit = std::vector<std::int32_t>;  // people who move together
  using Set = std::vector<Unit>;           // units that may take each other's place

  [[nodiscard]] double possible() const;

  Eigen::Index people_;
  bool signs_ = false;
  bool exhaustive_ = false;
  std::int64_t count_ = 0;
  std::uint64_t seed_ = 0;
  std::vector<Set> sets_;
};

}  // namespace explica::statistics
