// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

namespace explica::app {

/// Messages to standard error and to the log file: a progress bar with the time left on a terminal,
/// which of steps side by side shows the one that was first, and a line a step elsewhere.  May be
/// called from several threads.
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
  /// The step is over: the bar is another's.
  void endStep(const std::string& step);

 private:
  using Clock = std::chrono::steady_clock;
  struct Reached {
    double share = 0;  ///< the largest so far
    int lastTenth = -1;
    Clock::time_point began = Clock::now();
    std::string lastActivity = {};
  };

  void line(std::string_view kind, const std::string& message, bool shown);
  void drawBar(const Reached& reached, const std::string& activity);
  void clearBar();
  void noteLoss(int written, const std::string& where);

  mutable std::mutex mutex_;
  std::string lost_;
  std::string logPath_;
  Level level_ = Level::Normal;
  bool terminal_ = false;
  bool barShown_ = false;
  std::map<std::string, Reached> steps_;  ///< those that are not over, by name
  std::optional<std::string> step_;       ///< whose the bar is
  Clock::time_point lastDrawn_{};
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> log_;
};

/// Now, UTC, ISO 8601 to the second.
[[nodiscard]] std::string timeNow();

}  // namespace explica::app
