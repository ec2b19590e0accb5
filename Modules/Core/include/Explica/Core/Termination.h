// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"

#include <array>

namespace explica {

/// Why an iterative method stopped.  Only bad input is an exception; these are results.
enum class Termination {
  NotRun,         ///< nothing was done yet
  Finished,       ///< all was done without a criterion, or it came to rest short of its goals
  Converged,      ///< the method's own criterion holds
  TargetReached,  ///< the value that the user asked for was reached
  MaxIterations,  ///< stopped at the iteration limit
  MaxTime,        ///< stopped at the time limit
  Interrupted,    ///< the user or the system asked to stop
  Stalled         ///< no further progress is possible
};
constexpr auto enumWords(Termination) {
  using enum Termination;
  return std::to_array<EnumWord<Termination>>({{NotRun, "not-run"},
                                               {Finished, "finished"},
                                               {Converged, "converged"},
                                               {TargetReached, "target-reached"},
                                               {MaxIterations, "max-iterations"},
                                               {MaxTime, "max-time"},
                                               {Interrupted, "interrupted"},
                                               {Stalled, "stalled"}});
}

/// True if the method did what it was asked to do.
[[nodiscard]] constexpr bool reachedGoal(Termination t) {
  return t == Termination::NotRun || t == Termination::Finished || t == Termination::Converged ||
         t == Termination::TargetReached;
}

}  // namespace explica
