// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Testing/Command.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <limits>
#include <random>

namespace explica::testing {

/// Kills a command at moments drawn evenly from its whole duration. The duration is not measured
/// beforehand: it is the shortest that was seen, so that a machine that is slow for a while, or
/// quick for a while, changes which moments are met but not how many.
class KillMoments {
 public:
  explicit KillMoments(unsigned seed) : random_(seed) {}

  /// Runs a command line and kills it at the next moment.
  /// @return whether the kill came before the end
  bool kill(const std::vector<std::string>& words) {
    CommandSetting setting;
    setting.signal = SIGKILL;
    setting.signalAfter = std::uniform_real_distribution<double>(0, shortest_)(random_);
    const auto begin = std::chrono::steady_clock::now();
    if (explica(words, setting).exitCode == 128 + SIGKILL) return true;
    const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - begin;
    shortest_ = std::min(shortest_, whole.count());
    return false;
  }

 private:
  std::mt19937 random_;
  double shortest_ = 1e3;  // s: the first run is let through
};

}  // namespace explica::testing
