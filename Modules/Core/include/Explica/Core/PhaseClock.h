// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

namespace explica {

/// Adds the wall time of its scope to a phase's seconds.
class PhaseClock {
 public:
  explicit PhaseClock(double& seconds) : seconds_(seconds) {}
  ~PhaseClock() {
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  PhaseClock(const PhaseClock&) = delete;
  PhaseClock& operator=(const PhaseClock&) = delete;

 private:
  double& seconds_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace explica
