// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Limits.h"

#include "Explica/Application/Execute.h"
#include "Explica/Application/TimeKept.h"
#include "Explica/Core/Errors.h"
#include "Leavings.h"
#include "Signals.h"

#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <new>
#include <string>

namespace explica::app {
namespace {

constexpr double kGraceShare = 0.25;  // of the limit, for work to come to a consistent state
constexpr double kGraceSeconds = 10;  // for a command to write what it reached

std::atomic<TimeLimit*> limitOfProcess = nullptr;
std::atomic<double> secondsKept = 0;

std::chrono::steady_clock::duration duration(double seconds) {
  return std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(seconds));
}

/// The last words of a process; none where nobody takes them, for which nothing may wait.
void sayAtTheEnd(const std::string& message) {
  pollfd end = {STDERR_FILENO, POLLOUT, 0};
  if (poll(&end, 1, 0) <= 0) return;
  static_cast<void>(!write(STDERR_FILENO, message.data(), message.size()));
}

/// Ends the process without results from whichever thread gets no memory: an exception there would
/// not reach the command, or meet code of others that does not expect it.
void endForMemory() {
  std::set_new_handler(nullptr);
  rlimit limit{};
  getrlimit(RLIMIT_DATA, &limit);
  limit.rlim_cur = limit.rlim_max;  // what follows needs a little
  setrlimit(RLIMIT_DATA, &limit);
  removeLeavings();
  sayAtTheEnd("error: explica: " + std::string(kOutOfMemory) + '\n');
  _exit(kEnvironment);
}

}  // namespace

TimeLimit::TimeLimit(double seconds) : end_(Clock::now() + duration(seconds)) {
  const auto last = end_ + duration(kGraceShare * seconds + kGraceSeconds);
  guard_ = std::thread([this, last] {
    std::unique_lock<std::mutex> lock(mutex_);
    if (wake_.wait_until(lock, last, [this] { return over_; })) return;
    removeLeavings();
    sayAtTheEnd("error: explica: did not come to a stop after --max-time; ended without results\n");
    _exit(kEnvironment);
  });
  limitOfProcess = this;
}

TimeLimit::~TimeLimit() {
  limitOfProcess = nullptr;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    over_ = true;
  }
  wake_.notify_all();
  guard_.join();
}

bool TimeLimit::passed() {
  if (Clock::now() >= end_ - duration(secondsKept)) passed_ = true;
  return passed_;
}

bool timeIsOver() {
  TimeLimit* const limit = limitOfProcess;
  return limit != nullptr && limit->passed();
}

TimeKept::TimeKept(double seconds) : seconds_(seconds) {
  secondsKept += seconds_;
}

TimeKept::~TimeKept() {
  secondsKept -= seconds_;
}

Termination causeOf(Termination termination) {
  const bool byTime = termination == Termination::Interrupted && !signalled() && timeIsOver();
  return byTime ? Termination::MaxTime : termination;
}

void limitMemory(int megabytes) {
  rlimit limit{};
  getrlimit(RLIMIT_DATA, &limit);
  limit.rlim_cur = static_cast<rlim_t>(megabytes) << 20;
  if (limit.rlim_max != RLIM_INFINITY && limit.rlim_cur > limit.rlim_max) return;
  if (setrlimit(RLIMIT_DATA, &limit) != 0) {
    throw EnvironmentError(std::string("--max-memory cannot be set (") + std::strerror(errno) +
                           ")");
  }
  std::set_new_handler(endForMemory);
}

}  // namespace explica::app
