// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// What must hold for every command that writes a folder, on one quick run of each.

#include "QuickRuns.h"

#include "Explica/Core/Termination.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <utility>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

using EveryCommand = PreparedRun;

/// With other numbers of threads, and on a processor without fused arithmetic.
TEST_P(EveryCommand, GivesTheSameBytesOnAnyMachine) {
  const auto run = [&](const std::string& threads, const CommandSetting& setting) {
    const std::string out = folder_ / ("threads-" + threads);
    const auto result =
        explica(words_ + std::vector<std::string>{"--threads", threads, "--out", out}, setting);
    EXPECT_TRUE(result.exitCode == 0 || result.exitCode == 3) << result;
    return std::pair{stableHashes(out), readJson(out + "/provenance.json")["results"]};
  };
  CommandSetting older;
  older.environment["GLIBC_TUNABLES"] = "glibc.cpu.hwcaps=-AVX512F,-AVX2,-FMA,-FMA4";
  const auto first = run("1", {});
  EXPECT_FALSE(first.first.empty());
  EXPECT_EQ(run("3", {}), first);
  EXPECT_EQ(run("2", older), first);
}

TEST_P(EveryCommand, IsRecordedVerifiedAndReplayed) {
  const auto made = explica(words_ + std::vector<std::string>{"--out", folder_ / "a"});
  ASSERT_TRUE(made.exitCode == 0 || made.exitCode == 3) << made;
  EXPECT_NE(readJson(folder_ / "a/summary.json")["termination"], "not-run");
  const auto verified = explica({"verify", "--deep", folder_ / "a"});
  EXPECT_EQ(verified.exitCode, 0) << verified;
  const auto replayed = explica({"replay", folder_ / "a", "--out", folder_ / "b"});
  EXPECT_EQ(replayed.exitCode, 0) << replayed;
}

/// How the rows end that iterate; the limits are too small for those that have one.
std::string endOf(const std::string& name) {
  static const std::map<std::string, std::string> ends = {
      {"Embed", "max-iterations"},
      {"EmbedBand", "max-iterations"},
      {"Flatten", "converged"},
      {"FlattenCut", "converged"},
      {"Inflate", "max-iterations"},
      {"Polygon", "target-reached"},
      {"PolygonGlobalFlow", "max-iterations"},
      {"PolygonPhantom", "target-reached"},
      {"Repair", "converged"},
      {"Segment", "max-iterations"},
      {"Sphere", "converged"},
      {"Thickness", "converged"},
      {"Unfold", "max-iterations"},
  };
  const auto found = ends.find(name);
  return found == ends.end() ? "finished" : found->second;
}

TEST_P(EveryCommand, SaysTruthfullyHowItEnded) {
  const auto made = explica(words_ + std::vector<std::string>{"--out", folder_ / "a"});
  const auto record = readJson(folder_ / "a/provenance.json");
  const auto summary = readJson(folder_ / "a/summary.json");
  const std::string end = summary["termination"];
  EXPECT_EQ(record["termination"], end);
  EXPECT_EQ(end, endOf(GetParam().name));
  EXPECT_TRUE(reachedGoal(valueOf<Termination>(end)) || made.exitCode == 3) << made;
  const auto limit = std::find(words_.begin(), words_.end(), "--max-iterations");
  EXPECT_EQ(limit != words_.end(), end == "max-iterations");
  if (limit != words_.end() && summary.contains("iterations")) {
    EXPECT_EQ(summary["iterations"], std::stoi(*(limit + 1)));
  }
  EXPECT_EQ(summary.value("pairs_after", 0), 0) << "left by Repair, which says converged";
  if (end == "target-reached") {
    EXPECT_GE(summary["visibility_final"].get<double>(),
              record["options"]["target-visibility"].get<double>());
  }
}

TEST_P(EveryCommand, WritesTheReportOfItsResultsWhereAskedTo) {
  const bool may =
      explica({words_[0], words_[1], "--help-all"}).out.find("--report") != std::string::npos;
  const auto made = explica(words_ + std::vector<std::string>{"--report", "--out", folder_ / "a"});
  if (!may) {
    EXPECT_EQ(made.exitCode, 1) << made;
    return;
  }
  ASSERT_TRUE(made.exitCode == 0 || made.exitCode == 3) << made;
  const std::string page = readText(folder_ / "a/report.html");
  EXPECT_EQ(explica({"verify", folder_ / "a"}).exitCode, 0);
  fs::remove(folder_ / "a/report.html");
  ASSERT_EQ(explica({"report", folder_ / "a"}).exitCode, 0);
  EXPECT_EQ(readText(folder_ / "a/report.html"), page);
}

TEST_P(EveryCommand, WritesNothingInADryRun) {
  const auto before = folder_.entries();
  const auto result =
      explica(words_ + std::vector<std::string>{"--dry-run", "--out", folder_ / "a"});
  EXPECT_EQ(result.exitCode, 0) << result;
  EXPECT_EQ(folder_.entries(), before);
}

TEST_P(EveryCommand, LeavesNothingOnAFullDisk) {
  const auto before = folder_.entries();
  CommandSetting setting;
  setting.fileSizeLimit = 400;  // room for the lock file only
  const auto result = explica(words_ + std::vector<std::string>{"--out", folder_ / "a"}, setting);
  EXPECT_EQ(result.exitCode, 4) << result;
  auto after = folder_.entries();
  EXPECT_EQ(after, before);
}

INSTANTIATE_TEST_SUITE_P(Quick, EveryCommand, ::testing::ValuesIn(quickRuns()),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace explica::testing
