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

TEST_P(EveryCommand, GivesTheSameBytesWithAnyNumberOfThreads) {
  const auto run = [&](const std::string& threads) {
    const std::string out = folder_ / ("threads-" + threads);
    const auto result =
        explica(words_ + std::vector<std::string>{"--threads", threads, "--out", out});
    EXPECT_TRUE(result.exitCode == 0 || result.exitCode == 3) << result;
    return std::pair{stableHashes(out), readJson(out + "/provenance.json")["results"]};
  };
  const auto first = run("1");
  EXPECT_FALSE(first.first.empty());
  EXPECT_EQ(run("3"), first);
}

/// How the rows end that iterate; the limits are too small for those that have one.
std::string endOf(const std::string& name) {
  static const std::map<std::string, std::string> ends = {
      {"Embed", "max-iterations"},   {"Flatten", "converged"},
      {"FlattenCut", "converged"},   {"Inflate", "max-iterations"},
      {"Polygon", "target-reached"}, {"PolygonPhantom", "target-reached"},
      {"Repair", "converged"},       {"Segment", "max-iterations"},
      {"Sphere", "converged"},       {"Thickness", "converged"},
      {"Unfold", "max-iterations"},
  };
  const auto found = ends.find(name);
  return found == ends.end() ? "finished" : found->second;
}

/// What the record of a run that has ended says of its end.
void expectTruth(const CommandResult& made, const std::string& out, const QuickRun& row) {
  const auto record = readJson(out + "/provenance.json");
  const auto summary = readJson(out + "/summary.json");
  const std::string end = summary["termination"];
  EXPECT_EQ(record["termination"], end);
  EXPECT_EQ(end, endOf(row.name));
  for (const auto& step : record["steps"]) {
    EXPECT_NE(step["termination"], "not-run") << step;
    EXPECT_EQ(step.dump().find("null"), std::string::npos) << step;
  }
  EXPECT_EQ(record["options"].dump().find("null"), std::string::npos) << record["options"];
  EXPECT_TRUE(reachedGoal(valueOf<Termination>(end)) || made.exitCode == 3) << made;
  const auto limit = std::find(row.words.begin(), row.words.end(), "--max-iterations");
  EXPECT_EQ(limit != row.words.end(), end == "max-iterations");
  if (limit != row.words.end() && summary.contains("iterations")) {
    EXPECT_EQ(summary["iterations"], std::stoi(*(limit + 1)));
  }
  EXPECT_EQ(summary.value("pairs_after", 0), 0) << "left by Repair, which says converged";
  if (end == "target-reached") {
    EXPECT_GE(summary["visibility_final"].get<double>(),
              record["options"]["target-visibility"].get<double>());
  }
}

/// The page that a command writes on its results is the one that `explica report` makes of them.
void expectTheSamePage(const std::string& out) {
  const std::string page = readText(out + "/report.html");
  fs::remove(out + "/report.html");
  ASSERT_EQ(explica({"report", out}).exitCode, 0);
  EXPECT_EQ(readText(out + "/report.html"), page);
}

TEST_P(EveryCommand, IsRecordedReportedVerifiedAndReplayed) {
  std::vector<std::string> words = words_ + std::vector<std::string>{"--out", folder_ / "a"};
  const bool reports =
      explica({words_[0], words_[1], "--help-all"}).out.find("--report") != std::string::npos;
  const auto with = explica(words + std::vector<std::string>{"--report"});
  const auto made = reports ? with : explica(words);
  if (!reports) {
    EXPECT_EQ(with.exitCode, 1) << with;
  }
  ASSERT_TRUE(made.exitCode == 0 || made.exitCode == 3) << made;
  expectTruth(made, folder_ / "a", GetParam());
  const auto verified = explica({"verify", "--deep", folder_ / "a"});
  EXPECT_EQ(verified.exitCode, 0) << verified;
  const auto replayed = explica({"replay", folder_ / "a", "--out", folder_ / "b"});
  EXPECT_EQ(replayed.exitCode, 0) << replayed;
  if (reports) expectTheSamePage(folder_ / "a");
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
