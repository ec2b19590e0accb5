// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Console.h"

#include "Explica/Core/Errors.h"
#include "Explica/Provenance/Record.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>

namespace explica::app {
namespace {

constexpr char kFirstLine[] = "log of explica, process ";

/// True if the file holds something else than a log of ours: an input named by mistake must not
/// grow a log at its end.
bool isAnotherFile(const std::filesystem::path& path) {
  std::error_code fault;
  if (!std::filesystem::is_regular_file(path, fault)) return false;
  std::ifstream file(path);
  std::string start(200, '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  return !start.empty() && start.substr(0, start.find('\n')).find(kFirstLine) == std::string::npos;
}

/// How long a step will still take, by how long it took so far; empty at its start.
std::string timeLeft(double reached, std::chrono::duration<double> taken) {
  if (reached <= 0) return "";
  const double seconds = std::ceil(taken.count() * (1 - reached) / reached);
  char text[32];
  if (seconds < 100) {
    std::snprintf(text, sizeof text, ", %.0f s left", seconds);
  } else {
    std::snprintf(text, sizeof text, ", %.0f min left", std::ceil(seconds / 60));
  }
  return text;
}

}  // namespace

std::string timeNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return text;
}

Console::Console() : terminal_(isatty(STDERR_FILENO) == 1), log_(nullptr, &std::fclose) {}

Console::~Console() {
  endProgress();
}

void Console::openLog(const std::string& path) {
  if (isAnotherFile(path)) {
    throw UsageError(path + ": --log would be appended to this file, which is no log of explica");
  }
  // Without waiting: a pipe that nobody reads is an error, not a reason to stand still.
  const int descriptor =
      open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC | O_NONBLOCK, 0666);
  if (descriptor >= 0) {
    fcntl(descriptor, F_SETFL, fcntl(descriptor, F_GETFL) & ~O_NONBLOCK);
    log_.reset(fdopen(descriptor, "a"));
  }
  if (!log_) {
    throw EnvironmentError(path + ": the log cannot be written (" + std::strerror(errno) + ")");
  }
  logPath_ = path;
  line("", kFirstLine + std::to_string(getpid()), false);
  if (!lost_.empty()) throw EnvironmentError(lost_);
}

std::string Console::lost() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return lost_;
}

void Console::noteLoss(int written, const std::string& where) {
  if (written >= 0 || errno == EBADF || !lost_.empty()) return;
  lost_ = where + " (" + std::strerror(errno) + ")";
}

void Console::line(std::string_view kind, const std::string& said, bool shown) {
  const std::string message = provenance::printable(said);
  const std::lock_guard<std::mutex> lock(mutex_);
  if (log_) {
    const int written = std::fprintf(log_.get(), "%s %.*s%s\n", timeNow().c_str(),
                                     static_cast<int>(kind.size()), kind.data(), message.c_str());
    noteLoss(std::min(written, std::fflush(log_.get())), logPath_ + ": the log cannot be written");
  }
  if (!shown) return;
  clearBar();
  noteLoss(
      std::fprintf(stderr, "%.*s%s\n", static_cast<int>(kind.size()), kind.data(), message.c_str()),
      "messages are lost: standard error cannot be written");
}

void Console::info(const std::string& message) {
  line("", message, level_ != Level::Quiet);
}
void Console::detail(const std::string& message) {
  line("", message, level_ == Level::Verbose);
}
void Console::warning(const std::string& message) {
  line("warning: ", message, true);
}
void Console::error(const std::string& message) {
  line("error: ", message, true);
}

void Console::progress(double fraction, const std::string& step, std::string_view said) {
  if (!std::isfinite(fraction)) return;
  const std::string activity = provenance::printable(step + std::string(said));
  bool shown = false;
  int tenth = 0;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    Reached& reached = steps_[step];
    const bool isBeside = step_ && !step.starts_with(*step_) && !step_->starts_with(step);
    if (!isBeside) step_ = step;
    reached.share = std::clamp(fraction, reached.share, 1.0);
    tenth = static_cast<int>(reached.share * 10);
    if (terminal_ && level_ != Level::Quiet && !isBeside) drawBar(reached, activity);
    if (activity == reached.lastActivity && tenth == reached.lastTenth) return;
    // A step of a run takes one line; a command on its own one for each tenth.
    const bool worthALine = step.empty() ? tenth > reached.lastTenth : reached.lastTenth < 0;
    shown = !terminal_ && (level_ == Level::Verbose || (level_ == Level::Normal && worthALine));
    reached.lastActivity = activity;
    reached.lastTenth = tenth;
  }
  line("", activity + ": " + std::to_string(tenth * 10) + " %", shown);
}

void Console::drawBar(const Reached& reached, const std::string& activity) {
  constexpr auto kRedraw = std::chrono::milliseconds(100);  // often enough to be seen to move
  const auto now = Clock::now();
  if (activity == reached.lastActivity && now - lastDrawn_ <= kRedraw && reached.share < 1) return;
  constexpr int kWidth = 30;  // characters
  const auto filled = static_cast<std::size_t>(reached.share * kWidth);
  std::string bar(filled, '=');
  bar.resize(kWidth, ' ');
  std::fprintf(stderr, "\r\033[K[%s] %3d %%%s  %s", bar.c_str(),
               static_cast<int>(reached.share * 100),
               timeLeft(reached.share, now - reached.began).c_str(), activity.c_str());
  std::fflush(stderr);
  barShown_ = true;
  lastDrawn_ = now;
}

void Console::endProgress() {
  const std::lock_guard<std::mutex> lock(mutex_);
  clearBar();
}

void Console::endStep(const std::string& step) {
  const std::lock_guard<std::mutex> lock(mutex_);
  steps_.erase(step);
  if (step_ != step) return;
  step_.reset();
  clearBar();
}

void Console::clearBar() {
  if (!barShown_) return;
  std::fprintf(stderr, "\r\033[K");
  barShown_ = false;
}

}  // namespace explica::app
