// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Unfolding/Unfold.h"

#include <vector>

namespace explica::unfolding {

/// Says when an unfolding is over: for batch runs and for a window alike.
class StopRule {
 public:
  /// @throws InvalidInput  an option out of range
  explicit StopRule(const UnfoldOptions& options);

  /// Looks at the account so far, the start's row included.
  ///
  /// A target counts as reached once areas and lengths have settled, too.  Where lengths and
  /// contacts balance the visibility below a target, its term is strengthened, up to a limit; where
  /// a part of the region is held below its surroundings, these are parted further.  A run that has
  /// come to rest goes on as long as too little of the region is seen, but more and more.
  /// @return NotRun as long as another iteration pays
  [[nodiscard]] Termination check(Unfolder& unfolder,
                                  const std::vector<IterationRecord>& history) const;

 private:
  [[nodiscard]] bool targetHolds(const std::vector<IterationRecord>& history) const;
  static bool isStillAppearing(Unfolder& unfolder);
  /// Without a target: weighs what is seen against lengths for the next step.
  [[nodiscard]] Termination weigh(Unfolder& unfolder,
                                  const std::vector<IterationRecord>& history) const;

  UnfoldOptions options_;
};

}  // namespace explica::unfolding
