// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>

namespace explica {

/// Frames of a run at most: each holds a whole surface.
inline constexpr int kMostFrames = 1000;

/// What a command keeps of its limit for what is no iteration, in times of its start.
struct KeptTime {
  /// For the start itself, and for what comes after: an unfolding tests, measures and writes then
  /// what it read, tested and measured at the start, and has taken 0.5 to 3.4 times as long.
  double whole = 3;
  double frame = 0.2;  ///< for each frame: one of an unfolding is tested where it moved and written
};

/// Seconds for the iterations within the limit of a whole command.
/// @param start  s, that reading and testing took
/// @return > 0: one look at the state, and it ends
[[nodiscard]] inline double timeToIterate(double limit, double start, int frames,
                                          const KeptTime& kept = {}) {
  constexpr double kLeast = 1e-3;  // s
  return std::max(kLeast, limit - start * (kept.whole + kept.frame * frames));
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

}  // namespace explica
