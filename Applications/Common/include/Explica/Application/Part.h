// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"

#include <functional>
#include <memory>

namespace explica::app {

/// A part of a command's steps that is done beside other parts.  It keeps an account of its own
/// until all are done, so that the command's does not depend on which was faster.
class Part {
 public:
  /// @param whole       outlives the part
  /// @param stopWanted  ends this part, too; called by several threads at a time
  Part(Context& whole, std::function<bool()> stopWanted);
  Part(Part&&) noexcept;
  ~Part();

  /// To run steps by; for one thread at a time.
  [[nodiscard]] Context& context() { return context_; }

  /// Adds times, records, flags and reasons of the steps to the whole.  Once, and one part after
  /// another.
  void join();

 private:
  Context::State& whole_;
  std::unique_ptr<Context::State> own_;
  Context context_;
};

}  // namespace explica::app
