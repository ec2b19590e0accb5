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

/// Drives an unfolding to the solution that its goals define, for batch runs and for a window
/// alike.
///
/// Of visibility v and mean edge strain s, with goals v* and s*, it seeks the least g for which
///
///     v >= v* - g   and   s <= s* + trade g,   areas kept, nothing crossing
///
/// (goal attainment, [Gembicki1975]).  For a given strength m of the visibility term the steps
/// minimise S + m (1 - v); both v and s of such minima rise with m, so that the m at which both
/// constraints hold alike is found by steering m alone (Phase says what a step is for).  m ends
/// where one per cent of visibility would cost more strain than it is worth (trade).
class Continuation {
 public:
  /// @throws InvalidInput  an option out of range
  explicit Continuation(const UnfoldOptions& options);

  /// Says whether a run is over and, if it is not, steers its next step.
  ///
  /// It is over where both goals are met with something to spare, or where it is at rest: neither
  /// visibility nor strain changes although the visibility term is steered.  Then areas have to be
  /// kept, and what is seen has to increase no more.
  /// @param history  the account so far, the start's row included
  /// @return NotRun as long as another iteration pays
  [[nodiscard]] Termination next(Unfolder& unfolder,
                                 const std::vector<IterationRecord>& history) const;

 private:
  struct Outlook;
  [[nodiscard]] Outlook outlook(Unfolder& unfolder,
                                const std::vector<IterationRecord>& history) const;
  [[nodiscard]] Termination endOf(Unfolder& unfolder, const std::vector<IterationRecord>& history,
                                  const Outlook& now) const;
  void steer(Unfolder& unfolder, const Outlook& now) const;

  UnfoldOptions options_;
};

}  // namespace explica::unfolding
