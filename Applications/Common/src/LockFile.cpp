// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "LockFile.h"

#include "Console.h"
#include "Explica/Core/Errors.h"
#include "Explica/Provenance/Record.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <fstream>
#include <sstream>

namespace explica::app {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

constexpr auto kSilence = std::chrono::minutes(10);  // a host silent for so long is taken for dead

std::string hostName() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

/// Clock ticks at which a process began: tells a process from a later one of the same number.
std::string processStart(long pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  std::string text((std::istreambuf_iterator<char>(stat)), {});
  const auto close = text.rfind(')');
  if (close == std::string::npos) return "";
  std::istringstream fields(text.substr(close + 1));
  std::string field;
  constexpr int kStartField = 20;  // 22nd of proc(5), counted after the command's name
  for (int i = 0; i < kStartField; ++i) fields >> field;
  return field;
}

bool writeAll(int descriptor, const std::string& text) {
  return write(descriptor, text.data(), text.size()) == static_cast<ssize_t>(text.size());
}

}  // namespace

std::string ownLock(const std::string& command) {
  return provenance::textOf({{"host", hostName()},
                             {"pid", static_cast<long>(getpid())},
                             {"process_start", processStart(getpid())},
                             {"started", timeNow()},
                             {"command", command}}) +
         "\n";
}

/// A file without a name is written, then named.  File systems without such files (some network
/// ones) get it by exclusive creation; a kill between that and the text leaves an empty lock, which
/// ages out.
LockAttempt makeLock(const fs::path& lock, const std::string& text) {
  const int nameless = open(lock.parent_path().c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  if (nameless >= 0) {
    LockAttempt attempt;
    const std::string source = "/proc/self/fd/" + std::to_string(nameless);
    attempt.created = writeAll(nameless, text) && linkat(AT_FDCWD, source.c_str(), AT_FDCWD,
                                                         lock.c_str(), AT_SYMLINK_FOLLOW) == 0;
    if (!attempt.created) attempt.fault = errno;
    close(nameless);
    if (attempt.created || attempt.fault == EEXIST || attempt.fault == ENOSPC) return attempt;
  }
  const int descriptor = open(lock.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
  if (descriptor < 0) return {false, errno};
  const LockAttempt attempt{true, writeAll(descriptor, text) ? 0 : errno};
  close(descriptor);
  return attempt;
}

std::string holderOf(const fs::path& lock) {
  Json held;
  try {
    held = provenance::readJson(lock);
  } catch (const IOError&) {
    // One that is just being written, or is gone.
  }
  std::error_code fault;
  const auto touched = fs::last_write_time(lock, fault);
  if (fault) return "";
  const bool silent = fs::file_time_type::clock::now() - touched > kSilence;
  const auto word = [&](const char* key) {
    const auto found = held.find(key);
    return found != held.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  if (!held.is_object() || !held.contains("pid") || !held["pid"].is_number_integer())
    return silent ? "" : "a run that is just starting";
  const std::string host = word("host");
  const long pid = held["pid"].get<long>();
  if (host == hostName()) {
    if (kill(static_cast<pid_t>(pid), 0) != 0 && errno == ESRCH) return "";
    const std::string start = processStart(pid);
    if (!start.empty() && start != word("process_start")) return "";
  } else if (silent) {
    return "";
  }
  return "process " + std::to_string(pid) + " on " + host + " (explica " + word("command") +
         ", since " + word("started") + ")";
}

}  // namespace explica::app
