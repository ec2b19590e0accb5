// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Core/StopScope.h"

namespace explica::app {

/// Work that only describes a result, such as maps and pictures of it: an interrupted run goes
/// without, and says so.  Files are written whole or not at all (Core/WholeFile.h).
/// @param termination  of the command: becomes Interrupted then
template <class Work>
void describing(Context& context, Termination& termination, const Work& work) {
  try {
    const StopScope abandoned(&context.monitor());
    checkpoint();
    work();
  } catch (const Interrupted&) {
    context.warn("interrupted: some of what describes the result is left out");
    termination = Termination::Interrupted;
  }
}

}  // namespace explica::app
