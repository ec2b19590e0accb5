// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Unfolding/Unfold.h"

#include <vector>

namespace explica::unfolding {

// What the account of a run so far, the start's row included, says about where it is going.

/// True if the last iterations brought the visibility no further.
/// @param since  iteration from which on they count
[[nodiscard]] bool isSettled(const std::vector<IterationRecord>& history, int since);

/// True if lengths no longer recover: the strain fell by less than 0.4 % over the last steps.
[[nodiscard]] bool isRelaxed(const std::vector<IterationRecord>& history);

/// Visibility to aim at: more than asked for, as long as lengths have as much to spare; less than
/// that where both lack.
[[nodiscard]] double goalAt(double strain);

/// How the next step shall differ from the last.
struct Steering {
  double factor = 1;     ///< of the visibility term
  bool nearGoal = true;  ///< what is seen comes to its goal without it
};

/// Weighs what is seen against lengths: with v the visibility that the run is bound for and g the
/// goal at the strain that it is bound for, the factor is sqrt((1 - v) / (1 - g)), because against
/// springs the deficit 1 - v falls about with the square of the visibility term; at most 1.15 and
/// at least its inverse.
[[nodiscard]] Steering steer(const std::vector<IterationRecord>& history);

/// True if the last steps still opened the region, by more than tightening areas may cost.
[[nodiscard]] bool isGaining(const std::vector<IterationRecord>& history);

/// True if the last steps changed neither what is seen nor lengths by anything that counts.
[[nodiscard]] bool isAtRest(const std::vector<IterationRecord>& history);

/// True if a face of the collar is stretched beyond what it should be and is still giving way back:
/// one that is caught in a contact stays as it is, and is no reason to go on.
[[nodiscard]] bool isTorn(const std::vector<IterationRecord>& history);

/// How much stronger the visibility term has to be for a goal.  Against springs the deficit 1 - v
/// falls with its square: a quarter of the way at a time, since lengths are better spared.
[[nodiscard]] double driveFactor(double visibility, double goal);

}  // namespace explica::unfolding
