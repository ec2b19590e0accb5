// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Core/Termination.h"
#include "Explica/Pipeline/Plan.h"
#include "Explica/Pipeline/RunState.h"
#include "Settings.h"

#include <exception>
#include <vector>

namespace explica::app {

/// How the steps of a run went.
struct StepsDone {
  std::vector<pipeline::StepNote> notes;
  Termination worst = Termination::NotRun;  ///< of the last step that did not reach its goal
  std::exception_ptr failure;               ///< of the first step that failed
};

/// Does the steps of a plan in order, those of two hemispheres side by side (not under a limit of
/// memory, which one at a time need less of).  A stop leaves out the steps that have not begun.
///
/// A step that fails ends a run that cannot be resumed, and nothing stays; in another run those
/// that do not need it go on.
/// @throws the failure that ended it
[[nodiscard]] StepsDone doSteps(Context& context, const RunSettings& s,
                                const std::vector<pipeline::PlannedStep>& plan);

}  // namespace explica::app
