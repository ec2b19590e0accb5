// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>

namespace explica::unfolding {

/// Seconds for the iterations within the limit of a whole command.  Three times the start is kept:
/// for itself, and twice as long for what comes after, which tests, measures and writes what the
/// start read, tested and measured, and has taken 0.5 to 3.4 times as long; and for each frame,
/// which is tested where it moved and written, a fifth of it.
/// @param start  s, that reading and testing took
/// @return > 0: one look at the state, and it ends
[[nodiscard]] inline double timeToIterate(double limit, double start, int frames) {
  constexpr double kKept = 3, kFrameShare = 0.2;
  constexpr double kLeast = 1e-3;  // s
  return std::max(kLeast, limit - start * (kKept + kFrameShare * frames));
}

/// Whether another step fits into what is left of a run's time: one as long as the last.
class TimeBudget {
 public:
  /// @param limit  s; none: every step fits
  explicit TimeBudget(std::optional<double> limit) : limit_(limit) {}

  /// @param elapsed  s since the run began
  [[nodiscard]] bool fits(double elapsed) const { return !limit_ || elapsed + last_ <= *limit_; }
  void stepTook(double seconds) { last_ = seconds; }

 private:
  std::optional<double> limit_;
  double last_ = 0;
};

}  // namespace explica::unfolding
