// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Testing/Command.h"

#include <ostream>
#include <string>
#include <vector>

namespace explica::testing {

/// A small, quick use of a command, without --out.  {folder} stands for a folder in which `before`
/// has been run.
struct QuickRun {
  std::string name;
  std::vector<std::vector<std::string>> before;  ///< command lines that make its inputs
  std::vector<std::string> words;
};

inline void PrintTo(const QuickRun& run, std::ostream* stream) {
  *stream << run.name;
}

/// One row a command: tried for equal bytes with 1, 2 and 4 threads, replay, dry run and full disk.
inline const std::vector<QuickRun>& quickRuns() {
  static const std::vector<QuickRun> runs = {
      {"PhantomShell", {}, {"phantom", "shell", "--size", "24"}},
  };
  return runs;
}

/// Words with {folder} filled in.
inline std::vector<std::string> filled(std::vector<std::string> words,
                                       const TemporaryFolder& folder) {
  for (auto& word : words) {
    for (auto at = word.find("{folder}"); at != std::string::npos; at = word.find("{folder}")) {
      word.replace(at, 8, folder.path().string());
    }
  }
  return words;
}

inline std::vector<std::string> operator+(std::vector<std::string> words,
                                          const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

}  // namespace explica::testing
