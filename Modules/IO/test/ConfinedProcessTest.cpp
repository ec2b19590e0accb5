// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ConfinedProcess.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <vector>

namespace {

using explica::io::ConfinedProcess;

constexpr std::size_t kMemory = 50'000'000;

/// Whether a byte came from a process that sends one after `work`.
template <typename Work>
bool ends(const Work& work) {
  const ConfinedProcess process(kMemory, [&](const ConfinedProcess::Send& send) {
    work();
    send("", 1);
  });
  char byte = 1;
  return process.receive(&byte, 1) && byte == '\0';
}

TEST(ConfinedProcess, WhatItSendsArrivesAndThenNothing) {
  std::vector<int> sent(300'000);  // more than a pipe holds
  std::iota(sent.begin(), sent.end(), 0);
  const ConfinedProcess process(kMemory, [&](const ConfinedProcess::Send& send) {
    send(sent.data(), sent.size() * sizeof(int));
  });
  std::vector<int> received(sent.size());
  ASSERT_TRUE(process.receive(received.data(), received.size() * sizeof(int)));
  EXPECT_EQ(received, sent);
  EXPECT_FALSE(process.receive(received.data(), 1));
}

TEST(ConfinedProcess, FaultsEndItAndNotThisProgram) {
  EXPECT_TRUE(ends([] {}));
  EXPECT_FALSE(ends([] { throw std::runtime_error("damaged"); }));
  for (const int fault : {SIGSEGV, SIGABRT, SIGFPE, SIGILL, SIGBUS}) {
    EXPECT_FALSE(ends([&] { std::raise(fault); })) << fault;
  }
}

TEST(ConfinedProcess, MemoryBeyondItsLimitIsRefused) {
  const auto take = [](std::size_t bytes) { return std::vector<char>(bytes, 'a'); };
  EXPECT_TRUE(ends([&] { take(kMemory / 5); }));
  EXPECT_FALSE(ends([&] { take(4 * kMemory); }));
}

TEST(ConfinedProcess, WorkWithoutEndEnds) {
  EXPECT_FALSE(ends([] {
    for (volatile bool goOn = true; goOn;) {
    }
  }));
}

TEST(ConfinedProcess, ItDoesNotOutliveItsReader) {
  const ConfinedProcess process(kMemory, [](const ConfinedProcess::Send& send) {
    for (;;) send("waits for a reader", 18);
  });
}

}  // namespace
