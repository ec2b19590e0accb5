// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Collision/Proximity.h"

#include <algorithm>

namespace explica::collision {

/// How near a pair may come on its way.
struct AdvanceOptions {
  double keptDistance = 0;  ///< mm: a pair keeps it, or four fifths of its distance if that is less
  double leastDistance = 0;  ///< mm: a pair that is farther apart stays so, step after step

  /// What a pair keeps of its distance at the start, mm.
  [[nodiscard]] double gap(double start) const {
    constexpr double kKeptShare = 0.1, kNearShare = 0.8;
    // Pairs halt before it: distances are rounded down, and what that gives away adds up.
    constexpr double kHalt = 3, kCreep = 1e-4;
    const double kept = std::max(kKeptShare * start, std::min(kNearShare * start, keptDistance));
    if (!(start > leastDistance)) return kept;
    return std::max(kept,
                    std::min(kHalt * leastDistance, start - kCreep * (start - leastDistance)));
  }
};

/// Largest t found in [0, limit] such that for every time in [0, t] the pair x + time * motion
/// stays apart by the options' gap() of its distance at the start, by additive conservative
/// advancement [Li2021] that also knows how fast the features close along the line between their
/// nearest points.
///
/// Conservative in floating point: each advance uses distances that are rounded down and speeds
/// that are rounded up, so that no contact in [0, t] is missed.  The result may be smaller than the
/// true time; it is 0 for a pair that already touches.
[[nodiscard]] double safeTime(PairKind kind, const FourPoints& x, const FourPoints& motion,
                              double limit = 1, const AdvanceOptions& options = {});

/// Bound on the speed at which the pair's two features can approach each other, mm per unit time.
[[nodiscard]] double approachBound(PairKind kind, const FourPoints& motion);

}  // namespace explica::collision
