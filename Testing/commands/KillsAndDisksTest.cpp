// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// What every command that writes a folder leaves when it is killed, asked to end, or when the disk
// fills up while it writes; on one quick run of each.

#include "Explica/Testing/KillMoments.h"
#include "Explica/Testing/SmallDisk.h"
#include "Explica/Testing/Stops.h"
#include "Explica/Testing/WholeFiles.h"
#include "QuickRuns.h"

#include <gtest/gtest.h>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

class KillsAndDisks : public PreparedRun {
 protected:
  void SetUp() override {
    PreparedRun::SetUp();
    if (HasFatalFailure()) return;
    words_.emplace_back("--force");
    const auto whole = explica(into(folder_ / "undisturbed"));
    ASSERT_TRUE(whole.exitCode == 0 || whole.exitCode == 3) << whole;
    expected_ = stableHashes(folder_ / "undisturbed");
    exitCode_ = whole.exitCode;
    ASSERT_FALSE(expected_.empty());
  }

  [[nodiscard]] std::vector<std::string> into(const std::string& out) const {
    return words_ + std::vector<std::string>{"--out", out};
  }

  void expectTheSameBytesIn(const std::string& out) const {
    const CommandResult again = explica(into(out));
    ASSERT_EQ(again.exitCode, exitCode_) << again;
    ASSERT_EQ(differences(stableHashes(out), expected_), std::vector<std::string>());
  }

  void expectWholeFilesAfterKills() const;
  void expectStopsAreInterruptions() const;
  void expectBytesOrASentenceAtLimits() const;
  void expectWholeFilesOnAFullDisk() const;

  Hashes expected_;
  int exitCode_ = -1;
};

void KillsAndDisks::expectWholeFilesAfterKills() const {
  constexpr int kKills = 2;
  const auto before = folder_.entries();
  KillMoments moments(20261122);
  int killed = 0;
  for (int run = 0; killed < kKills; ++run) {
    SCOPED_TRACE("run " + std::to_string(run));
    ASSERT_LT(run, 10 * kKills) << "only " << killed << " runs were killed before their end";
    // A fresh folder, and one that is there: results appear in two different ways.
    const std::string out = folder_ / (run % 2 ? "fresh" : "there");
    if (run % 2 == 0) fs::create_directories(out);
    if (moments.kill(into(out))) {
      ++killed;
      ASSERT_EQ(damagedFiles(out, expected_), std::vector<std::string>());
    }
    expectTheSameBytesIn(out);
    fs::remove_all(out);
  }
  EXPECT_EQ(folder_.entries(), before);
}

/// Wherever it is asked to end: interrupted, never a verdict on the data.  What is reached is
/// there, marked and verified, or nothing is.
void KillsAndDisks::expectStopsAreInterruptions() const {
  const auto entries = folder_.entries();
  const std::string out = folder_ / "out";
  const long checks = checksFor(into(out));
  ASSERT_GT(checks, 0);
  fs::remove_all(out);
  for (const long check : momentsOf(checks, 10)) {
    SCOPED_TRACE("check " + std::to_string(check) + " of " + std::to_string(checks));
    const CommandResult ended = explica(into(out), stopAtCheck(check));
    ASSERT_TRUE(isInterrupted(ended)) << ended;
    if (fs::exists(out)) {
      EXPECT_EQ(readJson(out + "/provenance.json")["termination"], "interrupted");
      EXPECT_EQ(explica({"verify", out}).exitCode, 0);
    }
    fs::remove_all(out);
    ASSERT_EQ(folder_.entries(), entries);  // neither stage nor lock
  }
  expectTheSameBytesIn(out);
  fs::remove_all(out);
}

/// Of memory, then of time: the first of those is over before any work, the second at some moment.
void KillsAndDisks::expectBytesOrASentenceAtLimits() const {
  const auto before = folder_.entries();
  const std::string out = folder_ / "out";
  for (const char* megabytes : {"64", "160", "400"}) {
    SCOPED_TRACE(megabytes);
    const CommandResult ended =
        explica(into(out) + std::vector<std::string>{"--max-memory", megabytes});
    if (ended.exitCode == exitCode_) {
      EXPECT_EQ(differences(stableHashes(out), expected_), std::vector<std::string>());
      fs::remove_all(out);
    } else {
      EXPECT_EQ(ended.exitCode, 4) << ended;
      EXPECT_NE(ended.err.find("out of memory"), std::string::npos) << ended;
    }
    EXPECT_EQ(folder_.entries(), before);
  }
  for (const char* seconds : {"1e-9", "0.05"}) {
    SCOPED_TRACE(seconds);
    const CommandResult ended =
        explica(into(out) + std::vector<std::string>{"--max-time", seconds});
    if (!overran(ended)) {
      EXPECT_TRUE(ended.exitCode == 0 || ended.exitCode == 3) << ended;
      EXPECT_TRUE(!fs::exists(out) || explica({"verify", out}).exitCode == 0);
      fs::remove_all(out);
    }
    EXPECT_EQ(folder_.entries(), before);  // neither stage nor lock
  }
}

/// Room that the files of a folder take, in kB.
long kilobytesOf(const fs::path& folder) {
  constexpr long kPage = 4;  // kB
  long sum = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      sum += kPage * (static_cast<long>(entry.file_size()) / (1024 * kPage) + 1);
    }
  }
  return sum;
}

void KillsAndDisks::expectWholeFilesOnAFullDisk() const {
  const long needed = kilobytesOf(folder_ / "undisturbed");
  for (const long eighths : {1, 7}) {
    const long size = std::max(8L, needed * eighths / 8 / 4 * 4);
    SCOPED_TRACE(std::to_string(size) + " of " + std::to_string(needed) + " kB");
    const SmallDisk disk(folder_ / "disk", std::to_string(size) + "k");
    if (!disk.mounted()) GTEST_SKIP() << "skipped: this user may not mount a small file system";
    const std::string out = folder_ / "disk/out";
    const CommandResult full = explica(into(out));
    EXPECT_EQ(full.exitCode, 4) << full;
    EXPECT_NE(full.err.find("o space left on"), std::string::npos) << full;
    EXPECT_EQ(damagedFiles(out, expected_), std::vector<std::string>());
    disk.resize("100m");
    expectTheSameBytesIn(out);
  }
}

/// One test a command: all four are held to the one undisturbed run.
TEST_P(KillsAndDisks, LeaveWholeFilesOrNoneAndTheRerunGivesTheSameBytes) {
  expectWholeFilesAfterKills();
  expectStopsAreInterruptions();
  expectBytesOrASentenceAtLimits();
  expectWholeFilesOnAFullDisk();
}

INSTANTIATE_TEST_SUITE_P(Quick, KillsAndDisks, ::testing::ValuesIn(quickRuns()),
                         [](const auto& row) { return row.param.name; });

}  // namespace
}  // namespace explica::testing
