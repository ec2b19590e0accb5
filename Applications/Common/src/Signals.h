// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

namespace explica::app {

/// True once one of the signals that ask for an end has come: SIGINT, SIGTERM, SIGHUP, SIGQUIT or
/// SIGUSR1.
[[nodiscard]] bool signalled();

/// As signalled(), for work that asks whether it should stop.  With EXPLICA_STOP_AT_CHECK=N in the
/// environment a signal comes, as it were, when this is asked for the N-th time: stops at moments
/// that no clock decides.
[[nodiscard]] bool endWanted();

/// How often endWanted() was asked; nothing without EXPLICA_STOP_AT_CHECK.
[[nodiscard]] std::optional<long> checksMade();

/// From now on the first such signal asks work to stop.  The second ends the process at once,
/// without stages and locks left.  A pipe that nobody reads any more is a failed write, and no
/// signal; SIGHUP that was ignored (nohup) stays so.
void catchSignals();

}  // namespace explica::app
