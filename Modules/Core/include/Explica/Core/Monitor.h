// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace explica {

/// How long work speaks to whoever started it.  Libraries never print; they call these, if set.
struct Monitor {
  /// Share of the work done, in [0, 1], and what is being done.
  std::function<void(double fraction, std::string_view activity)> onProgress;
  /// A fact that the user should know though the work goes on; recorded with the result.
  std::function<void(const std::string& message)> onWarning;
  /// True if the work should stop at the next consistent state.
  std::function<bool()> stopWanted;

  void progress(double fraction, std::string_view activity) const {
    if (onProgress) onProgress(fraction, activity);
  }
  void warn(const std::string& message) const {
    if (onWarning) onWarning(message);
  }
  [[nodiscard]] bool shouldStop() const { return stopWanted && stopWanted(); }
  /// For a part of the work, whose progress counts from one share of the whole to another.
  [[nodiscard]] Monitor part(double from, double to) const {
    Monitor inner = *this;
    if (onProgress) {
      inner.onProgress = [outer = onProgress, from, to](double fraction,
                                                        std::string_view activity) {
        outer(from + (to - from) * fraction, activity);
      };
    }
    return inner;
  }
};

}  // namespace explica
