// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"

#include <array>
#include <utility>

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

template <>
struct EnumNames<Termination> {
  static constexpr std::array table = {std::pair{Termination::NotRun, "not-run"},
                                       std::pair{Termination::Finished, "finished"},
                                       std::pair{Termination::Converged, "converged"},
                                       std::pair{Termination::TargetReached, "target-reached"},
                                       std::pair{Termination::MaxIterations, "max-iterations"},
                                       std::pair{Termination::MaxTime, "max-time"},
                                       std::pair{Termination::Interrupted, "interrupted"},
                                       std::pair{Termination::Stalled, "stalled"}};
};

/// True if the method did what it was asked to do.
[[nodiscard]] constexpr bool reachedGoal(Termination t) {
  return t == Termination::NotRun || t == Termination::Finished || t == Termination::Converged ||
         t == Termination::TargetReached;
}

}  // namespace explica
