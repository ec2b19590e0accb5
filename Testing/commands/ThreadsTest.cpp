// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The same bytes with 1, 2 and 4 threads, for every command: one row each.

#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

namespace explica::testing {
namespace {

/// A command line; {folder} stands for a folder in which `before` has been run.
struct ThreadsRow {
  std::string name;
  std::vector<std::vector<std::string>> before;  ///< what makes its inputs
  std::vector<std::string> words;
};

void PrintTo(const ThreadsRow& row, std::ostream* stream) {
  *stream << row.name;
}

const ThreadsRow kRows[] = {
    {"PhantomShell", {}, {"phantom", "shell", "--size", "64"}},
};

class SameBytes : public ::testing::TestWithParam<ThreadsRow> {};

TEST_P(SameBytes, WhateverTheNumberOfThreads) {
  TemporaryFolder folder;
  const auto filled = [&](std::vector<std::string> words) {
    for (auto& word : words) {
      if (const auto at = word.find("{folder}"); at != std::string::npos) {
        word.replace(at, 8, folder.path().string());
      }
    }
    return words;
  };
  for (const auto& line : GetParam().before) {
    const auto made = explica(filled(line));
    ASSERT_EQ(made.exitCode, 0) << made;
  }
  std::map<std::string, std::string> first;
  nlohmann::ordered_json firstResults;
  for (const char* threads : {"1", "2", "4"}) {
    auto words = filled(GetParam().words);
    const std::string out = folder / ("threads-" + std::string(threads));
    words.insert(words.end(), {"--threads", threads, "--out", out});
    const auto result = explica(words);
    ASSERT_TRUE(result.exitCode == 0 || result.exitCode == 3) << result;
    const auto hashes = stableHashes(out);
    const auto results = readJson(out + "/provenance.json")["results"];
    EXPECT_FALSE(hashes.empty());
    if (first.empty()) {
      first = hashes;
      firstResults = results;
    }
    EXPECT_EQ(hashes, first) << threads << " threads";
    EXPECT_EQ(results, firstResults) << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(Commands, SameBytes, ::testing::ValuesIn(kRows),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace explica::testing
