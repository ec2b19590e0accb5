// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"

namespace explica {

/// Thrown where an end was asked for in work that is worth nothing half done.  No std::exception,
/// so that nobody takes it for a fault of the data.
struct Interrupted {};

/// Which monitor ends the work of this thread, and of the parallel loops that it starts, at a
/// checkpoint: before every block of such a loop, and where checkpoint() is called.  The innermost
/// scope counts: work whose state is of use half done runs to it in a scope without a monitor.
class StopScope {
 public:
  /// @param monitor  outlives the scope; its stopWanted may be called by several threads at a time.
  ///                 nullptr: checkpoints do nothing
  explicit StopScope(const Monitor* monitor) : outer_(current_) { current_ = monitor; }
  ~StopScope() { current_ = outer_; }
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;

  [[nodiscard]] static const Monitor* current() { return current_; }

 private:
  static inline constinit thread_local const Monitor* current_ = nullptr;
  const Monitor* outer_;
};

/// For long loops that are not parallel.
/// @throws Interrupted  the monitor of the scope asks for an end
inline void checkpoint() {
  const Monitor* const monitor = StopScope::current();
  if (monitor != nullptr && monitor->shouldStop()) throw Interrupted{};
}

/// As checkpoint(), by a monitor that is at hand.
inline void checkpoint(const Monitor& monitor) {
  if (monitor.shouldStop()) throw Interrupted{};
}

}  // namespace explica
