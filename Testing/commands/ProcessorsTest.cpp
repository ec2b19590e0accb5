// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Whole commands give the bytes of this processor on older ones too, which qemu stands in for: all
// that chooses by the processor at run time (Highway, Embree, TBB, ISA-L, the C library) then
// chooses as it would there.

#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>

namespace explica::testing {
namespace {

/// Rows whose bytes hang on the last digit of functions that are others on that processor: descents
/// that take thousands of steps, and cuts that are chosen by them.  Testing/README.md says by how
/// much they differ.
const std::map<std::string, std::set<std::string>>& onTheLastDigit() {
  static const std::map<std::string, std::set<std::string>> rows = {
      {"Nehalem", {"Embed", "EmbedBand", "FlattenCut", "PolygonPhantom", "Polygon"}},
      {"Haswell", {"Embed", "EmbedBand"}}};
  return rows;
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
    const auto hashes = stableHashes(out);
    EXPECT_EQ(hashes.size(), expected.size());
    if (onTheLastDigit().at(processor).contains(GetParam().name)) continue;
    EXPECT_EQ(hashes, expected);
  }
}

INSTANTIATE_TEST_SUITE_P(Quick, Processors, ::testing::ValuesIn(quickRuns()),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace explica::testing
