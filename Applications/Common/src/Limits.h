// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace explica::app {

/// The limit of --max-time.  Once it has passed, work is asked to stop.  What has not stopped when
/// a quarter of the time and ten seconds more are over, ends the process: exit code 4, no results,
/// no stages or locks left.
class TimeLimit {
 public:
  explicit TimeLimit(double seconds);
  ~TimeLimit();
  TimeLimit(const TimeLimit&) = delete;
  TimeLimit& operator=(const TimeLimit&) = delete;

  /// Less the time that is kept for output; once passed, it stays so.
  [[nodiscard]] bool passed();

 private:
  using Clock = std::chrono::steady_clock;

  Clock::time_point end_;
  std::atomic<bool> passed_ = false;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool over_ = false;
  std::thread guard_;
};

/// Whether the limit of this process, if it has one, has passed.
[[nodiscard]] bool timeIsOver();

/// What is said when memory, or room for another thread's, is at an end.
inline constexpr char kOutOfMemory[] =
    "out of memory (see --max-memory, ulimit -d, or the machine's)";

/// From now on this process gets no more than so many megabytes of its own.  Where it asks for more
/// it is ended: exit code 4, no results, no stages or locks left.
/// @throws EnvironmentError  the system refuses the limit
void limitMemory(int megabytes);

}  // namespace explica::app
