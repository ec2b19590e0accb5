// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Signals.h"

#include "Leavings.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <thread>

namespace explica::app {
namespace {

std::atomic<int> signalCount = 0;
static_assert(std::atomic<int>::is_always_lock_free);  // a handler may change it
std::optional<long> stopAt;                            ///< EXPLICA_STOP_AT_CHECK
std::atomic<long> checks = 0;
int endings[2] = {-1, -1};  ///< pipe by which the handler wakes the thread that ends the process

void endBySignal(int number) {
  signal(number, SIG_DFL);
  raise(number);
}

void onSignal(int number) {
  if (++signalCount == 1) return;
  const auto byte = static_cast<unsigned char>(number);
  if (endings[1] < 0 || write(endings[1], &byte, 1) != 1) endBySignal(number);
}

/// Waits for a second signal, for as long as the process lives.
void awaitEnding() {
  unsigned char byte = 0;
  while (read(endings[0], &byte, 1) != 1) {
  }
  removeLeavings();
  endBySignal(byte);
}

}  // namespace

bool signalled() {
  return signalCount > 0;
}

bool endWanted() {
  if (stopAt && ++checks == *stopAt) ++signalCount;
  return signalled();
}

std::optional<long> checksMade() {
  return stopAt ? std::optional(checks.load()) : std::nullopt;
}

void catchSignals() {
  if (const char* number = std::getenv("EXPLICA_STOP_AT_CHECK")) {
    stopAt = std::strtol(number, nullptr, 10);
  }
  if (pipe2(endings, O_CLOEXEC) == 0) {
    std::thread(awaitEnding).detach();
  }
  struct sigaction action {};
  action.sa_handler = onSignal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGUSR1}) {
    struct sigaction before {};
    sigaction(number, nullptr, &before);
    if (number == SIGHUP && before.sa_handler == SIG_IGN) continue;
    sigaction(number, &action, nullptr);
  }
  signal(SIGPIPE, SIG_IGN);
  // A file size limit then shows as a failed write, with its cause, instead of ending the process.
  signal(SIGXFSZ, SIG_IGN);
}

}  // namespace explica::app
