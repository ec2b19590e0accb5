// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Memory.h"

#include <gtest/gtest.h>

#include <sys/resource.h>

#include <cstddef>
#include <thread>
#include <vector>

namespace explica {
namespace {

long pageFaults() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_minflt;
}

TEST(Memory, FreedArraysServeTheNextOnes) {
#if !defined(__GLIBC__) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "another allocator than glibc's";
#endif
  constexpr std::size_t kBytes = std::size_t{64} << 20, kPage = 4096;
  keepFreedMemory();
  std::vector<char> first(kBytes, 1);
  std::vector<char>().swap(first);
  const long before = pageFaults();
  const std::vector<char> second(kBytes, 2);
  EXPECT_LT(pageFaults() - before, static_cast<long>(kBytes / kPage / 8));
  EXPECT_EQ(second.back(), 2);
}

TEST(Memory, WhatOneThreadFreedServesAnother) {
#if !defined(__GLIBC__) || defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "another allocator than glibc's";
#endif
  constexpr std::size_t kBytes = std::size_t{32} << 20, kPage = 4096;  // an arena holds 64 MB
  keepFreedMemory();
  std::vector<char> first(kBytes, 1);
  std::vector<char>().swap(first);
  const long before = pageFaults();
  std::thread([] { EXPECT_EQ(std::vector<char>(kBytes, 2).back(), 2); }).join();
  EXPECT_LT(pageFaults() - before, static_cast<long>(kBytes / kPage / 8));
}

}  // namespace
}  // namespace explica
