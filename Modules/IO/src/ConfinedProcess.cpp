// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ConfinedProcess.h"

#include "Explica/Core/Errors.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <fstream>

namespace explica::io {
namespace {

/// Seconds of processor time for work that may take so many bytes: far more than it needs.
constexpr rlim_t secondsFor(std::size_t memory) {
  return 2 + memory / 200'000'000;
}

void limit(decltype(RLIMIT_AS) what, rlim_t most) {
  const rlimit both = {most, most};
  setrlimit(what, &both);
}

/// Ends at a fault at once and silently, whatever handlers this program or its host has.
void confine(std::size_t mostMemory) {
  for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGPIPE, SIGALRM}) {
    std::signal(fault, SIG_DFL);
  }
  if (const int nowhere = open("/dev/null", O_WRONLY); nowhere >= 0) dup2(nowhere, STDERR_FILENO);
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  limit(RLIMIT_AS, pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + mostMemory);
  const rlim_t seconds = secondsFor(mostMemory);
  limit(RLIMIT_CPU, seconds);
  alarm(static_cast<unsigned>(6 * seconds));  // of waiting, as for another thread's lock
  limit(RLIMIT_CORE, 0);
}

}  // namespace

ConfinedProcess::ConfinedProcess(std::size_t mostMemory,
                                 const std::function<void(const Send&)>& work) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw EnvironmentError("no pipe could be made");
  child_ = fork();
  if (child_ == 0) {
    confine(mostMemory);
    close(ends[0]);
    try {
      work([&](const void* from, std::size_t count) {
        const auto* next = static_cast<const char*>(from);
        while (count > 0) {
          const ssize_t sent = write(ends[1], next, count);
          if (sent < 0) _exit(EXIT_FAILURE);
          next += sent;
          count -= static_cast<std::size_t>(sent);
        }
      });
    } catch (...) {
      _exit(EXIT_FAILURE);
    }
    _exit(EXIT_SUCCESS);
  }
  close(ends[1]);
  pipe_ = ends[0];
  if (child_ < 0) {
    close(pipe_);
    throw EnvironmentError("no process could be made");
  }
}

ConfinedProcess::~ConfinedProcess() {
  close(pipe_);
  kill(child_, SIGKILL);
  while (waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

bool ConfinedProcess::receive(void* to, std::size_t count) const {
  auto* next = static_cast<char*>(to);
  while (count > 0) {
    const ssize_t got = read(pipe_, next, count);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    next += got;
    count -= static_cast<std::size_t>(got);
  }
  return true;
}

}  // namespace explica::io
