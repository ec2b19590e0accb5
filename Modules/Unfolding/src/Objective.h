// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "energies/Energy.h"

namespace explica::unfolding {

/// The sum of all terms: one Energy for each row of kTerms.
class Objective {
 public:
  Objective();

  /// @param account  gets the value of every term, and the time spent
  /// @return their sum, mm^2
  double value(const Configuration& now, const TermValues& strengths,
               IterationRecord& account) const;

  /// V x 3.
  [[nodiscard]] Positions gradient(const Configuration& now, const TermValues& strengths,
                                   IterationRecord& account) const;

  /// Adds a positive semi-definite part of the Hessian.
  void addStiffness(const Configuration& now, const TermValues& strengths,
                    const std::vector<std::int32_t>& unknown, BlockSystem& system) const;

 private:
  Terms energies_;
};

}  // namespace explica::unfolding
