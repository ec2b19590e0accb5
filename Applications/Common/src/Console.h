// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace explica::app {

/// Messages to standard error and to the log file: a progress bar with the time left on a
/// terminal, a line a step elsewhere. May be called from several threads.
class Console {
 public:
  enum class Level { Quiet, Normal, Verbose };

  Console();
  ~Console();
  void setLevel(Level level) { level_ = level; }
  /// @throws EnvironmentError  the file cannot be written
  void openLog(const std::string& path);
  /// Why messages to standard error or the log were lost; empty if none were.  A standard error
  /// that was closed from the start is as wished.
  [[nodiscard]] std::string lost() const;

  void info(const std::string& message);
  void detail(const std::string& message);
  void warning(const std::string& message);
  void error(const std::string& message);
  /// @param fraction  share of the step, or of the command; what falls is not shown
  /// @param step      of a run, as "surface-L: "; empty for a command on its own
  void progress(double fraction, const std::string& step, std::string_view said);
  void endProgress();

 private:
  using Clock = std::chrono::steady_clock;

  void line(std::string_view kind, const std::string& message, bool shown);
  void drawBar(const std::string& activity);
  void clearBar();
  void noteLoss(int written, const std::string& where);

  mutable std::mutex mutex_;
  std::string lost_;
  std::string logPath_;
  Level level_ = Level::Normal;
  bool terminal_ = false;
  bool barShown_ = false;
  int lastTenth_ = -1;
  double reached_ = 0;  ///< the largest share of this step
  std::optional<std::string> step_;
  Clock::time_point stepBegan_{};
  std::string lastActivity_;
  Clock::time_point lastDrawn_{};
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> log_;
};

/// Now, UTC, ISO 8601 to the second.
[[nodiscard]] std::string timeNow();

}  // namespace explica::app
