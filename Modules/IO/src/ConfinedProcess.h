// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>

namespace explica::io {

/// A forked process for the work of a library that a damaged file may crash: it ends alone, and its
/// results come through a pipe.  It starts no threads, prints nothing, and dies with the last
/// reader of its pipe.
class ConfinedProcess {
 public:
  using Send = std::function<void(const void* from, std::size_t count)>;

  /// @param mostMemory  bytes that the work may take beyond what this process has
  /// @param work        what it sends is received here; an exception ends it as a crash does
  /// @throws EnvironmentError  no process could be made
  ConfinedProcess(std::size_t mostMemory, const std::function<void(const Send&)>& work);
  ~ConfinedProcess();
  ConfinedProcess(const ConfinedProcess&) = delete;
  ConfinedProcess& operator=(const ConfinedProcess&) = delete;

  /// Waits for the next bytes that were sent; false if the process ended before.
  [[nodiscard]] bool receive(void* to, std::size_t count) const;

 private:
  pid_t child_ = -1;
  int pipe_ = -1;
};

}  // namespace explica::io
