// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Contacts.h"

namespace explica::unfolding {

/// Share of a step below which the pairs that stop it are dealt with.
inline constexpr double kBlocked = 0.3;

/// A step that has been proposed, and what stands in its way.
struct Motion {
  Positions by = {};                              ///< V x 3, mm
  double descent = 0;                             ///< gradient . by
  double safe = 0;                                ///< share of it that collision detection allows
  std::vector<collision::Meeting> meetings = {};  ///< on the way, or within range of it
};

/// Finds `meetings` and `safe` of a motion from `x`.
void findSafeStep(const Contacts& contacts, const Positions& x, Motion& motion);

/// Where pairs stop the motion before kBlocked of it, they go along as one, or stay where something
/// holds them; where that leads from one pair to the next, they go as far as they may, and the rest
/// goes on.  A motion that nothing stops stays as it is.
/// @param unknown   V: -1 for vertices that stay
/// @param gradient  V x 3, of the objective
void clearWay(const Contacts& contacts, const Positions& x,
              const std::vector<std::int32_t>& unknown, const Positions& gradient, Motion& motion);

}  // namespace explica::unfolding
