// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Pipeline/Plan.h"
#include "Explica/Provenance/Json.h"
#include "Settings.h"

namespace explica::app {

/// What the plan says of a step, on top what the user set with the step's prefix, and what only the
/// results of steps before it tell.
/// @throws UsageError  --t2 where there is no first image
[[nodiscard]] provenance::Json stepValues(const Context& context, const RunSettings& s,
                                          const pipeline::PlannedStep& step);

/// @throws UsageError  hemispheres are asked for that the segmentation will not tell apart
void checkSides(const Context& context, const RunSettings& s, const pipeline::Plan& plan);

/// Says of each step whether --t2 can be used.
/// @throws UsageError  it cannot
void checkT2(const RunSettings& s, const pipeline::Plan& plan);

/// Warns of what is said to a step that --steps leaves out, as the file of a study may.
void warnOfIdleOptions(const Context& context, const RunSettings& s, const pipeline::Plan& plan);

}  // namespace explica::app
