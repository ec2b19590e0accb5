// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// What a study leaves when it is killed, when the disk is full, when inputs are bad or when two
// runs want the same folder.

#include "Explica/Testing/KillMoments.h"
#include "Explica/Testing/SmallDisk.h"
#include "Explica/Testing/Stops.h"
#include "Explica/Testing/WholeFiles.h"
#include "SmallStudy.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <thread>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

TEST(StudyTrust, AKillAtAnyMomentLeavesWholeFilesAndTheRerunGivesTheSameBytes) {
  const TemporaryFolder folder;
  const SmallStudy study(folder.path(), {"01"});
  ASSERT_EQ(explica(study.participants(folder / "undisturbed")).exitCode, 0);
  const Hashes expected = stableHashes(folder / "undisturbed");
  ASSERT_GT(expected.size(), 20u);

  constexpr unsigned kSeed = 20261121;
  constexpr int kKills = 12;
  KillMoments moments(kSeed);
  const std::string out = folder / "out";
  int killed = 0;
  for (int run = 0; killed < kKills; ++run) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", run " + std::to_string(run));
    ASSERT_LT(run, 10 * kKills) << "only " << killed << " runs were killed before their end";
    if (moments.kill(study.participants(out))) {
      ++killed;
      ASSERT_EQ(damagedFiles(out, expected), std::vector<std::string>());
      const CommandResult again = explica(study.participants(out));
      ASSERT_EQ(again.exitCode, 0) << again;
    }
    ASSERT_EQ(differences(stableHashes(out), expected), std::vector<std::string>());
    fs::remove_all(out);
  }
}

/// A table of what was interrupted calls nobody's data bad.
TEST(StudyTrust, AStopAtAnyCheckIsInterruptedInTheTablesToo) {
  const TemporaryFolder folder;
  const SmallStudy study(folder.path(), {"01"});
  const long checks = checksFor(study.participants(folder / "undisturbed"));
  const Hashes expected = stableHashes(folder / "undisturbed");
  for (const long check : momentsOf(checks, 10)) {
    SCOPED_TRACE("check " + std::to_string(check) + " of " + std::to_string(checks));
    const CommandResult ended =
        explica(study.participants(study.out(), {"--force"}), stopAtCheck(check));
    ASSERT_TRUE(isInterrupted(ended)) << ended;
    for (const std::string& name : folder.entries()) {
      EXPECT_EQ(name.find("explica-stage"), std::string::npos) << name;
      EXPECT_EQ(name.find("explica-lock"), std::string::npos) << name;
    }
    ASSERT_EQ(explica(study.group(study.out())).exitCode, 0);
    const std::string table = readText(study.out() + "/study.tsv");
    EXPECT_EQ(table.find("failed"), std::string::npos) << table;
    EXPECT_NE(table.find("interrupted"), std::string::npos) << table;
    fs::remove_all(study.out());
  }
  ASSERT_EQ(explica(study.participants(study.out())).exitCode, 0);
  EXPECT_EQ(differences(stableHashes(study.out()), expected), std::vector<std::string>());
}

TEST(StudyTrust, AStopAtAnyCheckIsInterruptedInTheTableOfHeartsToo) {
  const TemporaryFolder folder;
  const auto made = explica({"phantom", "ventricle", "--size", "48", "--spacing", "2.7", "--slice",
                             "8", "--frames", "2", "--out", folder / "beat"});
  ASSERT_EQ(made.exitCode, 0) << made;
  fs::create_directories(folder / "data/sub-1");
  fs::copy_file(folder / "beat/frame-0000.nii.gz", folder / "data/sub-1/a_dseg.nii.gz");
  const std::vector<std::string> words = {"study", "hearts", folder / "data", folder / "out"};
  const long checks = checksFor(words);
  fs::remove_all(folder / "out");
  for (const long check : momentsOf(checks, 10)) {
    SCOPED_TRACE("check " + std::to_string(check) + " of " + std::to_string(checks));
    const CommandResult ended = explica(words, stopAtCheck(check));
    ASSERT_TRUE(isInterrupted(ended)) << ended;
    const std::string table = readText(folder / "out/hearts.tsv");
    EXPECT_NE(table.find("interrupted"), std::string::npos) << table;
    fs::remove_all(folder / "out");
  }
}

/// Of what KillsAndDisks does not stop: tables of people, records, pages and pictures.
TEST(StudyTrust, AStopAtAnyCheckIsInterruptedInGroupsReplaysPagesAndPicturesToo) {
  const TemporaryFolder folder;
  const SmallStudy study(folder.path(), {"01", "02"});
  ASSERT_EQ(explica(study.participants(folder / "done")).exitCode, 0);
  const std::string run = folder / "done/runs/sub-01_hemi-L", surface = run + "/surface";
  const std::vector<std::vector<std::string>> rows = {
      study.group(folder / "done"),
      {"replay", surface, "--force", "--out", folder / "again"},
      {"report", run},
      {"view", surface + "/white.surf.gii", "--width", "64", "--height", "48", "--screenshot",
       folder / "a.png"},
  };
  for (const auto& words : rows) {
    const long checks = checksFor(words);
    EXPECT_GT(checks, 0) << words[0];
    for (const long check : momentsOf(checks, 10)) {
      const CommandResult ended = explica(words, stopAtCheck(check));
      EXPECT_TRUE(isInterrupted(ended)) << check << " of " << checks << ended;
    }
  }
}

/// The commands that KillsAndDisks does not try: of many runs, of records, of pages and pictures.
TEST(StudyTrust, LimitsHoldForCommandsOfManyRunsRecordsAndPictures) {
  const TemporaryFolder folder;
  const SmallStudy study(folder.path(), {"01"});
  ASSERT_EQ(explica(study.participants(folder / "done")).exitCode, 0);
  const std::string run = folder / "done/runs/sub-01_hemi-L", surface = run + "/surface";
  writeText(folder / "study.json", R"({"hemispheres": ["L"], "subjects": ["01"],
    "parameters": {"steps": ["surface"], "surface": {"faces": 1000}}, "input": ")" +
                                       study.labels("01").string() + R"("})");
  const std::vector<std::vector<std::string>> rows = {
      study.participants(folder / "out"),
      study.group(folder / "done"),
      {"study", "check", folder / "study.json"},
      {"study", "list", folder / "study.json"},
      {"study", "participant", folder / "study.json", folder / "of-file"},
      {"verify", "--deep", surface},
      {"history", surface},
      {"replay", surface, "--force", "--out", folder / "again"},
      {"report", run},
      {"view", surface + "/white.surf.gii", "--width", "64", "--height", "48", "--screenshot",
       folder / "a.png"},
      {"descriptors", "--force", "--out", folder / "descriptors"},
  };
  for (const auto& words : rows) {
    for (const char* megabytes : {"64", "200"}) {
      std::vector<std::string> limited = words;
      limited.insert(limited.end(), {"--max-memory", megabytes});
      const CommandResult ended = explica(limited);
      EXPECT_TRUE(ended.exitCode == 0 || ended.exitCode == 3 || ended.exitCode == 4) << ended;
      if (ended.exitCode == 4) {
        EXPECT_NE(ended.err.find("out of memory"), std::string::npos) << ended;
      }
    }
    std::vector<std::string> limited = words;
    limited.insert(limited.end(), {"--max-time", "1e-9"});
    const CommandResult ended = explica(limited);
    EXPECT_TRUE(ended.exitCode == 0 || ended.exitCode == 3 || overran(ended)) << words[0] << ended;
    for (const std::string& name : folder.entries()) {
      EXPECT_EQ(name.find("explica-stage"), std::string::npos) << name;
    }
  }
}

TEST(StudyTrust, AFullDiskLeavesWholeFilesAndMoreRoomGivesTheSameBytes) {
  const TemporaryFolder folder;
  const SmallStudy study(folder.path(), {"01"});
  fs::create_directories(folder / "wide");  // as deep as the small disk: links are relative
  ASSERT_EQ(explica(study.participants(folder / "wide/out")).exitCode, 0);
  const Hashes expected = stableHashes(folder / "wide/out");
  for (const char* size : {"16k", "64k", "128k", "256k"}) {
    SCOPED_TRACE(size);
    const SmallDisk disk(folder / "disk", size);
    if (!disk.mounted()) GTEST_SKIP() << "skipped: this user may not mount a small file system";
    const std::string out = folder / "disk/out";
    const CommandResult full = explica(study.participants(out));
    EXPECT_EQ(full.exitCode, 4) << full;
    EXPECT_NE(full.err.find("o space left on"), std::string::npos) << full;
    EXPECT_EQ(damagedFiles(out, expected), std::vector<std::string>());
    disk.resize("100m");
    const CommandResult again = explica(study.participants(out));
    ASSERT_EQ(again.exitCode, 0) << again;
    EXPECT_EQ(differences(stableHashes(out), expected), std::vector<std::string>());
  }
}

TEST(StudyTrust, AnUnreadableInputInTheMiddleIsARowAndStopsNobody) {
  const TemporaryFolder folder;
  const SmallStudy study(folder.path(), {"01", "02", "03", "04", "05"});
  fs::resize_file(study.labels("02"), fs::file_size(study.labels("02")) / 2);
  fs::remove(study.labels("03"));
  fs::create_symlink("/nowhere/labels.nii.gz", study.labels("03"));
  fs::remove(study.labels("05"));
  fs::create_symlink(study.labels("05").filename(), study.labels("05"));  // a loop of links
  const CommandResult run = explica(study.participants(study.out()));
  ASSERT_EQ(run.exitCode, 3) << run;
  const CommandResult group = explica(study.group(study.out()));
  ASSERT_EQ(group.exitCode, 0) << group;
  const std::string table = readText(study.out() + "/study.tsv");
  EXPECT_NE(table.find("sub-01\tL\tdone\t"), std::string::npos) << table;
  EXPECT_NE(table.find("sub-02\tL\tfailed: "), std::string::npos) << table;
  EXPECT_NE(table.find("sub-03\tL\tfailed: "), std::string::npos) << table;
  EXPECT_NE(table.find("sub-04\tL\tdone\t"), std::string::npos) << table;
  EXPECT_NE(table.find("sub-05\tL\tfailed: "), std::string::npos) << table;
  EXPECT_FALSE(fs::exists(study.out() + "/sub-02"));
  EXPECT_FALSE(fs::exists(study.out() + "/runs/sub-02_hemi-L/surface"));
}

TEST(StudyTrust, AnInputThatTurnsBadTakesItsOldResultsAway) {
  const TemporaryFolder folder;
  const SmallStudy study(folder.path(), {"01", "02"});
  ASSERT_EQ(explica(study.participants(study.out())).exitCode, 0);
  ASSERT_TRUE(fs::exists(study.out() + "/sub-02/anat/sub-02_hemi-L_pial.surf.gii"));
  fs::resize_file(study.labels("02"), 100);
  ASSERT_EQ(explica(study.participants(study.out())).exitCode, 3);
  EXPECT_FALSE(fs::exists(study.out() + "/sub-02/anat/sub-02_hemi-L_pial.surf.gii"));
  EXPECT_TRUE(fs::exists(study.out() + "/sub-01/anat/sub-01_hemi-L_pial.surf.gii"));
}

std::string thisHost() {
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  return host;
}

/// The process that a lock names, as soon as it names one; 0: none did for long.
pid_t holderOfLock(const fs::path& lock) {
  for (int look = 0; look < 20000; ++look) {
    try {
      return readJson(lock).at("pid").get<pid_t>();
    } catch (const std::exception&) {  // not there yet, or not yet written
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  return 0;
}

TEST(StudyTrust, ASecondRunIntoTheSameFolderNamesTheFirst) {
  const TemporaryFolder folder;
  const SmallStudy study(folder.path(), {"01", "02", "03", "04", "05", "06"});
  CommandResult first;
  std::thread running([&] { first = explica(study.participants(study.out())); });
  const pid_t holder = holderOfLock(study.out() + "/.explica-lock");
  const bool held = holder > 0 && kill(holder, SIGSTOP) == 0;
  const CommandResult second = explica(study.participants(study.out()));
  if (held) kill(holder, SIGCONT);
  running.join();
  EXPECT_TRUE(held);
  EXPECT_EQ(first.exitCode, 0) << first;
  EXPECT_EQ(second.exitCode, 4) << second;
  for (const std::string& part :
       {std::string("in use by process "), "on " + thisHost(), std::string("since 20")}) {
    EXPECT_NE(second.err.find(part), std::string::npos) << second;
  }
}

/// The lock of the one run that is at work on a share of a folder, as soon as there is one.
fs::path lockOfShare(const fs::path& folder) {
  for (int look = 0; look < 20000; ++look) {
    std::error_code fault;
    for (const auto& entry : fs::directory_iterator(folder, fault)) {
      if (entry.path().filename().string().starts_with(".explica-lock-")) return entry.path();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return {};
}

TEST(StudyTrust, DifferentParticipantsAreDoneSideBySide) {
  const TemporaryFolder folder;
  const SmallStudy study(folder.path(), {"01", "02"});
  const auto only = [&](const std::string& out, const std::string& label) {
    return explica(study.participants(out, {"--participant-label", label}));
  };
  CommandResult first;
  std::thread running([&] { first = only(study.out(), "01"); });
  const pid_t holder = holderOfLock(lockOfShare(study.out()));
  const bool held = holder > 0 && kill(holder, SIGSTOP) == 0;
  const CommandResult other = only(study.out(), "sub-02");
  const CommandResult same = only(study.out(), "sub-01");
  if (held) kill(holder, SIGCONT);
  running.join();
  ASSERT_TRUE(held);
  EXPECT_EQ(first.exitCode, 0) << first;
  EXPECT_EQ(other.exitCode, 0) << other;
  EXPECT_EQ(same.exitCode, 4) << same;
  EXPECT_NE(same.err.find("in use by process"), std::string::npos) << same;

  const std::string alone = folder / "alone";
  for (const char* label : {"01", "02"}) ASSERT_EQ(only(alone, label).exitCode, 0);
  for (const auto& out : {alone, study.out()}) {
    const CommandResult group = explica(study.group(out));
    ASSERT_EQ(group.exitCode, 0) << group;
  }
  EXPECT_EQ(differences(stableHashes(study.out()), stableHashes(alone)),
            std::vector<std::string>());
}

TEST(StudyTrust, ALockOfAnotherHostCountsUntilItIsSilent) {
  const TemporaryFolder folder;
  const SmallStudy study(folder.path(), {"01"});
  fs::create_directories(study.out());
  const fs::path lock = study.out() + "/.explica-lock";
  writeText(lock, R"({"host": "elsewhere", "pid": 1, "process_start": "1", )"
                  R"("started": "2026-01-01T00:00:00Z", "command": "bids"})");
  const CommandResult refused = explica(study.participants(study.out()));
  EXPECT_EQ(refused.exitCode, 4) << refused;
  EXPECT_NE(refused.err.find("process 1 on elsewhere"), std::string::npos) << refused;
  fs::last_write_time(lock, fs::file_time_type::clock::now() - std::chrono::minutes(11));
  const CommandResult taken = explica(study.participants(study.out()));
  EXPECT_EQ(taken.exitCode, 0) << taken;
  EXPECT_NE(taken.err.find("an earlier run was killed here"), std::string::npos) << taken;
}

}  // namespace
}  // namespace explica::testing
