// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace explica::app {

// What a process must not leave behind when it has to end before its work can stop by itself: locks
// and stages.  A second signal, and a time limit that was overrun, end it so.

/// From now until forgetLeaving(), the file or folder goes if the process ends at once.
void noteLeaving(const std::filesystem::path& path);
void forgetLeaving(const std::filesystem::path& path);

/// Removes all of them.  Safe in any thread, but not in a signal handler.
void removeLeavings();

}  // namespace explica::app
