// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica::app {

/// True once one of the signals that ask for an end has come: SIGINT, SIGTERM, SIGHUP, SIGQUIT or
/// SIGUSR1.
[[nodiscard]] bool signalled();

/// From now on the first such signal asks work to stop.  The second ends the process at once,
/// without stages and locks left.  A pipe that nobody reads any more is a failed write, and no
/// signal; SIGHUP that was ignored (nohup) stays so.
void catchSignals();

}  // namespace explica::app
