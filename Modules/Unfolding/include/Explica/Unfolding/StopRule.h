// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Unfolding/Unfold.h"

#include <vector>

namespace explica::unfolding {

/// Visibility to aim at, at a strain: the goal and a little more as long as lengths can pay for it,
/// less where they are strained beyond theirs.
[[nodiscard]] double aimAt(const UnfoldOptions& options, double strain);

/// Factor of the visibility term that leads to the aim: against springs the deficit 1 - visibility
/// falls with the square of the term.
/// @param visibility  that the run is bound for
[[nodiscard]] double steering(double visibility, double aim);

/// Drives an unfolding and says when it is over: for batch runs and for a window alike.
///
/// Of visibility v and mean edge strain s, with goals v* and s*, it seeks the least g for which
///
///     v >= v* - g   and   s <= s* + trade g,   areas kept, nothing crossing
///
/// (goal attainment, [Gembicki1975]).  For a given strength m of the visibility term the steps
/// minimise S + m (1 - v); both v and s of such minima rise with m, so that the m at which both
/// constraints hold alike is found by steering m alone.  It stops where one per cent of visibility
/// would cost more strain than it is worth (trade).
class StopRule {
 public:
  /// @throws InvalidInput  an option out of range
  explicit StopRule(const UnfoldOptions& options);

  /// Looks at the account so far, the start's row included.
  ///
  /// A run ends where both goals are met with something to spare, or where it is at rest: neither
  /// visibility nor strain changes although the visibility term is steered.  Then areas have to be
  /// kept, and what is seen has to increase no more.  Where a part of the region is held below its
  /// surroundings, these are parted further.
  /// @return NotRun as long as another iteration pays
  [[nodiscard]] Termination check(Unfolder& unfolder,
                                  const std::vector<IterationRecord>& history) const;

 private:
  /// @param change  of the last iterations
  [[nodiscard]] Termination steer(Unfolder& unfolder, const std::vector<IterationRecord>& history,
                                  double change) const;

  UnfoldOptions options_;
};

}  // namespace explica::unfolding
