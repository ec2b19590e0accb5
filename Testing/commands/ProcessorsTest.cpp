// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Whole commands give the bytes of this processor on older ones too, which qemu stands in for: all
// that chooses by the processor at run time (Highway, Embree, TBB, ISA-L, the C library) then
// chooses as it would there.

#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

namespace explica::testing {
namespace {

/// Pictures whose surface is met by rays that start from the processor's estimate of a reciprocal:
/// four of four million values are other ones, by 1 of 255.
const std::set<std::pair<std::string, std::string>>& onTheLastDigit() {
  static const std::set<std::pair<std::string, std::string>> pictures = {
      {"FlattenCut", "flat.png"}};
  return pictures;
}

/// The command on another processor.
CommandResult explicaOn(const std::string& processor, const std::vector<std::string>& words) {
  CommandSetting patient;
  patient.timeout = 3000;
  return runProgram(
      std::vector<std::string>{"qemu-x86_64", "-cpu", processor, EXPLICA_EXECUTABLE} + words,
      patient);
}

class Processors : public PreparedRun {};

TEST_P(Processors, OfOlderKindsGiveTheSameBytes) {
  if (runProgram({"bash", "-c", "command -v qemu-x86_64"}).exitCode != 0) {
    GTEST_SKIP() << "skipped: no qemu-x86_64 (Debian's qemu-user)";
  }
  const auto here = explica(words_ + std::vector<std::string>{"--out", folder_ / "here"});
  ASSERT_TRUE(here.exitCode == 0 || here.exitCode == 3) << here;
  const auto expected = stableHashes(folder_ / "here");
  ASSERT_FALSE(expected.empty());
  // SSE4.2 and nothing wider; AVX2 with fused multiply-add.
  for (const std::string processor : {"Nehalem", "Haswell"}) {
    SCOPED_TRACE(processor);
    const std::string out = folder_ / processor;
    const auto there = explicaOn(processor, words_ + std::vector<std::string>{"--out", out});
    ASSERT_EQ(there.exitCode, here.exitCode) << there;
    auto hashes = stableHashes(out);
    for (auto& [name, hash] : hashes) {
      if (processor == "Nehalem" && onTheLastDigit().contains({GetParam().name, name})) {
        hash = expected.at(name);
      }
    }
    EXPECT_EQ(hashes, expected);
  }
}

INSTANTIATE_TEST_SUITE_P(Quick, Processors, ::testing::ValuesIn(quickRuns()),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace explica::testing
