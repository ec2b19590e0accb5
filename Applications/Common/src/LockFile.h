// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace explica::app {

/// What came of an attempt to make a lock file.
struct LockAttempt {
  bool created = false;
  int fault = 0;  ///< errno; EEXIST if there is one already
};

/// What this process writes into its lock: host, process, time and command, as JSON.
[[nodiscard]] std::string ownLock(const std::string& command);

/// Makes the lock with its text in one stroke, so that a kill leaves it whole or not at all.
[[nodiscard]] LockAttempt makeLock(const std::filesystem::path& lock, const std::string& text);

/// Empty if the lock's owner is gone; else a sentence on who holds it.
[[nodiscard]] std::string holderOf(const std::filesystem::path& lock);

}  // namespace explica::app
