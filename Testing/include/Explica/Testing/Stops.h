// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Testing/Command.h"

#include <filesystem>
#include <string>
#include <vector>

namespace explica::testing {

/// A request to end at the n-th time that the program asks for one, whatever the clock says.
inline CommandSetting stopAtCheck(long n) {
  CommandSetting setting;
  setting.environment["EXPLICA_STOP_AT_CHECK"] = std::to_string(n);
  return setting;
}

/// How often a command asks whether it should end, if it never should.
inline long checksFor(const std::vector<std::string>& words) {
  const std::string said = explica(words, stopAtCheck(0)).err;
  const auto end = said.find(" checks for a stop");
  return end == std::string::npos ? 0 : std::stol(said.substr(said.rfind('\n', end) + 1));
}

/// A number of so many checks, evenly spread; fewer where there are not as many.
inline std::vector<long> momentsOf(long checks, int number) {
  std::vector<long> moments;
  for (int m = 0; m < number; ++m) {
    const long check = 1 + (2 * m + 1) * checks / (2 * number);
    if (check <= checks && (moments.empty() || check > moments.back())) moments.push_back(check);
  }
  return moments;
}

/// The first check at which a stop of `words`, on one thread, leaves a file in `out`.
inline long firstCheckThatLeaves(const std::string& file, const std::vector<std::string>& words,
                                 const std::filesystem::path& out) {
  const auto leaves = [&](long check) {
    std::filesystem::remove_all(out);
    (void)explica(words, stopAtCheck(check));
    return std::filesystem::exists(out / file);
  };
  std::filesystem::remove_all(out);
  long without = 0, with = checksFor(words);
  while (with - without > 1) {
    const long middle = (without + with) / 2;
    (leaves(middle) ? with : without) = middle;
  }
  std::filesystem::remove_all(out);
  return with;
}

/// Whether it ended as one that was asked to end, and says nothing else.
inline bool isInterrupted(const CommandResult& result) {
  return result.exitCode == 3 && contains(result.err, "interrupted") &&
         !contains(result.err, "failed") && !contains(result.err, "error:");
}

}  // namespace explica::testing
