// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// What every command has from Applications/Common, tried on the quickest of them.

#include "Explica/Application/TimeKept.h"
#include "Explica/Testing/KillMoments.h"
#include "Limits.h"

#include <gtest/gtest.h>

#include <signal.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>

namespace explica::testing {
namespace {

TEST(TimeLimit, TimeKeptForWhatFollowsEndsTheWorkEarlierAndForGood) {
  using app::timeIsOver;
  EXPECT_FALSE(timeIsOver());
  app::TimeLimit limit(1e6);
  EXPECT_FALSE(timeIsOver());
  EXPECT_EQ(app::causeOf(Termination::Interrupted), Termination::Interrupted);
  {
    const app::TimeKept half(5e5);
    EXPECT_FALSE(timeIsOver());
    const app::TimeKept rest(6e5);
    EXPECT_TRUE(timeIsOver());
  }
  EXPECT_TRUE(timeIsOver()) << "what was asked to end is not asked to go on";
  EXPECT_EQ(app::causeOf(Termination::Interrupted), Termination::MaxTime);
  EXPECT_EQ(app::causeOf(Termination::Converged), Termination::Converged);
}

namespace fs = std::filesystem;
using ::testing::Test;

/// Arguments of a small, quick run into `out`.
std::vector<std::string> shell(const std::string& out, std::vector<std::string> more = {}) {
  std::vector<std::string> words = {"phantom", "shell", "--size", "8", "--out", out};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST(Framework, EveryCommandHelpsFromItsDeclaration) {
  const auto all = nlohmann::ordered_json::parse(explica({"--describe"}).out);
  ASSERT_GE(all.size(), 3u);
  for (const auto& command : all) {
    const std::string name = command["command"];
    SCOPED_TRACE(name);
    EXPECT_FALSE(command["synopsis"].get<std::string>().empty());
    std::vector<std::string> words;
    if (const auto space = name.find(' '); space != std::string::npos) {
      words = {name.substr(0, space), name.substr(space + 1)};
    } else {
      words = {name};
    }
    words.push_back("--help-all");
    const auto help = explica(words);
    EXPECT_EQ(help.exitCode, 0);
    EXPECT_TRUE(help.err.empty()) << help.err;
    for (const auto& parameter : command["parameters"]) {
      const std::string dashes = parameter["positional"].get<bool>() ? "" : "--";
      EXPECT_TRUE(contains(help.out, dashes + parameter["name"].get<std::string>()));
      EXPECT_FALSE(parameter["help"].get<std::string>().empty()) << parameter["name"];
    }
  }
}

TEST(Framework, VersionNamesTheCommitAndWhatItWasBuiltWith) {
  const auto version = explica({"--version"});
  EXPECT_EQ(version.exitCode, 0);
  for (const char* word :
       {"explica ", "commit ", "built by ", "ITK 5", "VTK 9", "Eigen 3", "TBB 20"}) {
    EXPECT_TRUE(contains(version.out, word)) << word << version;
  }
}

TEST(Framework, WrongUseIsExitCodeOneWithAHint) {
  TemporaryFolder folder;
  const struct {
    std::vector<std::string> words;
    std::string expected;
  } rows[] = {
      {{}, "Usage"},
      {{"thikness"}, "unknown command 'thikness'"},
      {{"verfy", "x"}, "did you mean 'verify'?"},
      {{"phantom", "cube"}, "unknown kind 'cube'"},
      {{"phantom", "shell"}, "--out is missing"},
      {{"thickness"}, "nothing is given to work on; usage: explica thickness [SEG] --out DIR"},
      {{"run", "T1.nii.gz", "--hemi", "L", "--out", folder / "a"}, "did you mean --hemisphere?"},
      {{"run", "T1.nii.gz", "--hemispheres", "L"}, "did you mean --hemisphere?"},
      {{"flatten", "a.gii", "--overlay", "b.gii"}, "did you mean --map?"},
      {{"unfold", "a.gii", "--overwrite"}, "did you mean --force?"},
      {{"heart", "a.nii", "--movies", "b.nii"}, "unknown option --movies; see --help"},
      {{"surface", "a.nii", "--faces", "9"}, "100 to 100,000,000"},
      {{"view", folder.path().string(), "--screenshot", folder / "a.png"},
       "is a folder: --screenshot draws surfaces"},
      {{"verify"}, "PROVENANCE is missing"},
      {shell(folder / "a", {"--sizes", "3"}), "did you mean --size?"},
      {shell(folder / "a", {"--size", "9"}), "--size"},
      {shell(folder / "a", {"--spacing", "wide"}), "spacing: 'wide' is not a number"},
      {shell(folder / "a", {"--aspect", "1,2"}), "three numbers"},
      {shell(folder / "a", {"--aspect", "1", "1", "2"}),
       "--aspect: separate its numbers by commas, without spaces: --aspect 1,1,2"},
      {shell(folder / "a", {"--aspect", "1,", "1,", "-2"}), "without spaces: --aspect 1,1,-2"},
      {{"thickness", "x.nii", "--tissue", "2", "3", "--out", folder / "a"}, "--tissue 2,3"},
      {shell(folder / "a", {"surplus"}), "'surplus' was not expected"},
      {{"cifti", "lh.thickness"}, "was not expected: files are given by --left, --right"},
      {shell(folder / "a", {"--threads", "0"}), "threads: '0' is not within 1 to 4096"},
      {shell(folder / "a", {"--spacing"}), "--spacing"},
  };
  for (const auto& row : rows) {
    const auto result = explica(row.words);
    EXPECT_EQ(result.exitCode, 1) << result;
    EXPECT_TRUE(contains(result.err, row.expected)) << row.expected << "\n" << result;
    EXPECT_TRUE(result.out.empty()) << result;
  }
  EXPECT_TRUE(folder.entries().empty());
}

TEST(Framework, ARecordThatIsAbsentAndOneThatIsNoneAreToldApart) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "none");
  std::filesystem::create_directories(folder / "other");
  writeText(folder / "none/provenance.json", "{not json");
  writeText(folder / "other/provenance.json", R"({"command": "phantom shell"})");
  for (const char* command : {"verify", "history", "replay", "report"}) {
    std::vector<std::string> words = {command, folder / "none"};
    if (words[0] == "replay") words.insert(words.end(), {"--out", folder / "a"});
    for (const auto& [name, expected] :
         {std::pair{"none", "none/provenance.json, line 1: is not JSON"},
          {"other", "other/provenance.json: not a provenance record of Explica"}}) {
      words[1] = folder / name;
      const auto result = explica(words);
      EXPECT_EQ(result.exitCode, 2) << result;
      EXPECT_TRUE(contains(result.err, expected)) << result;
    }
  }
}

TEST(Framework, EveryPlaceToWriteIsCheckedBeforeTheWork) {
  const TemporaryFolder folder;
  writeText(folder / "file", "");
  ASSERT_EQ(explica({"phantom", "shell", "--size", "24", "--out", folder / "shell"}).exitCode, 0);
  const std::string labels = folder / "shell/labels.nii.gz", place = folder / "file/x";
  const std::vector<std::vector<std::string>> rows = {
      {"surface", labels, "--freesurfer", place, "--out", folder / "a"},
      {"run", labels, "--steps", "surface", "--surface.freesurfer", place, "--out", folder / "a"},
      {"surface", labels, "--out", place},
      {"surface", labels, "--log", place, "--out", folder / "a"},
  };
  const auto before = folder.entries();
  for (const auto& row : rows) {
    auto words = row;
    words.emplace_back("--verbose");
    const auto result = explica(words);
    EXPECT_TRUE(result.exitCode == 2 || result.exitCode == 4) << result;
    EXPECT_TRUE(contains(result.err, folder / "file")) << result;
    EXPECT_FALSE(contains(result.err, "tissue\n")) << "a step was begun: " << result;
    EXPECT_EQ(folder.entries(), before);
  }
}

TEST(Framework, AFolderWithoutARecordIsSaidSo) {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"verify"}, {"history"}, {"replay", "--out", folder / "a"}}) {
    auto all = words;
    all.insert(all.begin() + 1, folder.path().string());
    const auto result = explica(all);
    EXPECT_EQ(result.exitCode, 2) << result;
    EXPECT_TRUE(contains(result.err, "holds no provenance.json; name a folder")) << result;
  }
}

TEST(Framework, OptionsAreJudgedBeforeAnyFileIsOpened) {
  TemporaryFolder folder;
  writeText(folder / "rubbish.nii", "not a volume");
  writeText(folder / "rubbish.gii", "not a surface");
  const struct {
    std::vector<std::string> words;
    std::string expected;
  } rows[] = {
      {{"thickness", "rubbish.nii", "--inner", "1", "--tissue", "2", "--layers", "0"},
       "layers: '0' is not within 1 to 1000"},
      {{"unfold", "rubbish.gii", "--center", "0", "0", "19", "--radius", "5"},
       "--center: separate its numbers by commas, without spaces: --center 0,0,19"},
      {{"unfold", "rubbish.gii", "--center", "0,0,19", "--radius", "5", "--max-iterations", "-1"},
       "max-iterations: '-1' is not within 1 to 100,000"},
      {{"inflate", "rubbish.gii", "--max-iterations", "-1"},
       "max-iterations: '-1' is not within 1 to 100,000"},
      {{"flatten", "rubbish.gii", "--grid", "-1"}, "grid: '-1' is not "},
      {{"surface", "rubbish.nii", "--white", "3"}, "did you mean --white-label?"},
  };
  for (const auto& row : rows) {
    for (const bool exists : {false, true}) {
      std::vector<std::string> words = row.words;
      words[1] = folder / (exists ? words[1] : "no-" + words[1]);
      words.insert(words.end(), {"--out", folder / "a"});
      const auto result = explica(words);
      EXPECT_EQ(result.exitCode, 1) << result;
      EXPECT_TRUE(contains(result.err, row.expected)) << result;
      EXPECT_FALSE(contains(result.err, "rubbish")) << "the file has been looked at\n" << result;
    }
  }
  EXPECT_EQ(folder.entries().size(), 2u);
}

TEST(Framework, NegativeNumbersAreValuesNotOptions) {
  TemporaryFolder folder;
  const auto result = explica(shell(folder / "a", {"--aspect", "-1,2,2"}));
  EXPECT_EQ(result.exitCode, 2) << result;  // understood, and refused for what it says
  EXPECT_TRUE(contains(result.err, "must be positive")) << result;
  EXPECT_EQ(explica(shell(folder / "b", {"--spacing", "-.5"})).exitCode, 2);
}

TEST(Framework, ConfigurationFileIsOverruledByTheCommandLine) {
  TemporaryFolder folder;
  writeText(folder / "c.json", R"({"size": 10, "spacing": 0.5, "threads": 1})");
  const auto result = explica({"phantom", "shell", "--config", folder / "c.json", "--spacing",
                               "0.25", "--out", folder / "a"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto record = readJson(folder / "a/provenance.json");
  EXPECT_EQ(record["options"]["size"], 10);
  EXPECT_EQ(record["options"]["spacing"], 0.25);
  EXPECT_EQ(record["options"]["inner-radius"], 0.5);  // a default is recorded too
  EXPECT_EQ(record["execution"]["threads"]["count"], 1);

  writeText(folder / "wrong.json", R"({"sise": 10})");
  const auto wrong =
      explica({"phantom", "shell", "--config", folder / "wrong.json", "--out", folder / "b"});
  EXPECT_EQ(wrong.exitCode, 1);
  EXPECT_TRUE(contains(wrong.err, "did you mean 'size'?")) << wrong;
  writeText(folder / "broken.json", "{");
  EXPECT_EQ(explica({"phantom", "shell", "--config", folder / "broken.json", "--out", folder / "b"})
                .exitCode,
            2);
  EXPECT_FALSE(fs::exists(folder / "b"));
}

TEST(Framework, ThreadsFollowThePrecedence) {
  TemporaryFolder folder;
  const std::map<std::string, std::string> none = {
      {"EXPLICA_NTHREADS", ""}, {"SLURM_CPUS_PER_TASK", ""},
      {"NSLOTS", ""},           {"PBS_NCPUS", ""},
      {"OMP_NUM_THREADS", ""},  {"ITK_GLOBAL_DEFAULT_NUMBER_OF_THREADS", ""}};
  int run = 0;
  const auto threads = [&](const std::map<std::string, std::string>& extra,
                           std::vector<std::string> words = {}) {
    CommandSetting setting;
    setting.environment = none;
    for (auto& [name, value] : extra) setting.environment[name] = value;
    const std::string out = folder / std::to_string(run++);
    const auto result = explica(shell(out, std::move(words)), setting);
    EXPECT_EQ(result.exitCode, 0) << result;
    const auto record = readJson(out + "/provenance.json")["execution"]["threads"];
    return record["count"].dump() + " " + record["because"].get<std::string>();
  };
  EXPECT_EQ(threads({{"OMP_NUM_THREADS", "3,2"}}), "3 OMP_NUM_THREADS");
  EXPECT_EQ(threads({{"OMP_NUM_THREADS", "3"}, {"SLURM_CPUS_PER_TASK", "5"}}),
            "5 SLURM_CPUS_PER_TASK");
  EXPECT_EQ(threads({{"SLURM_CPUS_PER_TASK", "5"}, {"EXPLICA_NTHREADS", "2"}}),
            "2 EXPLICA_NTHREADS");
  EXPECT_EQ(threads({{"EXPLICA_NTHREADS", "2"}}, {"--threads", "4"}), "4 --threads");
  EXPECT_TRUE(contains(threads({}), "affinity"));
}

TEST(Framework, AFolderThatHoldsFilesIsRefusedUnlessForced) {
  TemporaryFolder folder;
  ASSERT_EQ(explica(shell(folder / "a")).exitCode, 0);
  writeText(folder / "a/mine.txt", "keep me");
  const auto refused = explica(shell(folder / "a"));
  EXPECT_EQ(refused.exitCode, 1);
  EXPECT_TRUE(contains(refused.err, "--force")) << refused;

  const auto forced = explica(shell(folder / "a", {"--force", "--spacing", "2"}));
  EXPECT_EQ(forced.exitCode, 0) << forced;
  EXPECT_EQ(readJson(folder / "a/provenance.json")["options"]["spacing"], 2.0);
  EXPECT_EQ(readText(folder / "a/mine.txt"), "keep me");
  EXPECT_EQ(explica({"verify", folder / "a"}).exitCode, 0);
}

TEST(Framework, AnOutputFolderThatIsALinkIsTheFolderThatIsMeant) {
  const TemporaryFolder folder;
  const auto into = [&](const std::string& out, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"phantom", "shell", "--size", "8", "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    return explica(words);
  };
  fs::create_directory(folder / "meant");
  fs::create_directory_symlink("meant", folder / "link");
  EXPECT_EQ(into(folder / "link").exitCode, 0);
  const auto expected = stableHashes(folder / "meant");
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(into(folder / "link").exitCode, 1);  // it holds files now
  EXPECT_EQ(into(folder / "link", {"--force"}).exitCode, 0);
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(stableHashes(folder / "meant"), expected);

  fs::create_directory_symlink("nowhere", folder / "dangling");
  const auto before = folder.entries();
  for (const auto& [out, said] : {std::pair{folder / "dangling", "a place that does not exist"},
                                  std::pair{std::string(), "--out is empty"}}) {
    const auto result = into(out);
    EXPECT_EQ(result.exitCode, 1) << result;
    EXPECT_NE(result.err.find(said), std::string::npos) << result;
  }
  EXPECT_EQ(folder.entries(), before);
}

TEST(Framework, BadInputLeavesNothingBehind) {
  TemporaryFolder folder;
  const auto result = explica(shell(folder / "deep/er/a", {"--inner-radius", "0.9"}));
  EXPECT_EQ(result.exitCode, 2) << result;
  EXPECT_TRUE(folder.entries().empty());

  fs::create_directory(folder / "there");
  EXPECT_EQ(explica(shell(folder / "there", {"--inner-radius", "0.9"})).exitCode, 2);
  EXPECT_EQ(folder.entries(), std::vector<std::string>{"there"});
}

TEST(Framework, ADryRunChecksAndWritesNothing) {
  TemporaryFolder folder;
  const auto result = explica(shell(folder / "a", {"--dry-run"}));
  EXPECT_EQ(result.exitCode, 0) << result;
  EXPECT_EQ(nlohmann::json::parse(result.out)["size"], 8);
  EXPECT_TRUE(folder.entries().empty());
  writeText(folder / "file", "x");
  EXPECT_EQ(explica(shell(folder / "file/a", {"--dry-run"})).exitCode, 4);
}

TEST(Framework, AFullDiskIsExitCodeFourAndLeavesNothing) {
  TemporaryFolder folder;
  CommandSetting setting;
  setting.fileSizeLimit = 2000;
  const auto result = explica({"phantom", "shell", "--size", "40", "--out", folder / "a"}, setting);
  EXPECT_EQ(result.exitCode, 4) << result;
  EXPECT_TRUE(contains(result.err, ".nii.gz")) << result;
  EXPECT_TRUE(folder.entries().empty());
}

TEST(Framework, AnOutputFolderThatCannotBeMadeIsExitCodeFour) {
  const auto result = explica(shell("/proc/nowhere/a"));
  EXPECT_EQ(result.exitCode, 4) << result;
  TemporaryFolder folder;
  writeText(folder / "file", "x");
  EXPECT_EQ(explica(shell(folder / "file")).exitCode, 1);
  EXPECT_EQ(explica(shell(folder / "file/a")).exitCode, 4);
  EXPECT_EQ(readText(folder / "file"), "x");
}

TEST(Framework, ASecondRunIntoTheSameFolderRefuses) {
  TemporaryFolder folder;
  fs::create_directory(folder / "a");
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  const std::string start = [] {  // of this very process, which is alive
    std::string text = readText("/proc/self/stat");
    text = text.substr(text.rfind(')') + 1);
    std::istringstream fields(text);
    std::string field;
    for (int i = 0; i < 20; ++i) fields >> field;
    return field;
  }();
  const auto lock = [&](long pid, const std::string& since) {
    return nlohmann::json{{"host", host},
                          {"pid", pid},
                          {"process_start", since},
                          {"started", "2026-01-01T00:00:00Z"},
                          {"command", "unfold"}}
        .dump();
  };
  writeText(folder / "a/.explica-lock", lock(getpid(), start));
  const auto refused = explica(shell(folder / "a"));
  EXPECT_EQ(refused.exitCode, 4) << refused;
  EXPECT_TRUE(contains(refused.err, std::to_string(getpid()))) << refused;
  EXPECT_TRUE(contains(refused.err, host)) << refused;

  // The same number, but of a process that began at another time: the owner is gone.
  writeText(folder / "a/.explica-lock", lock(getpid(), "1"));
  const auto taken = explica(shell(folder / "a"));
  EXPECT_EQ(taken.exitCode, 0) << taken;
  EXPECT_TRUE(contains(taken.err, "killed")) << taken;
  EXPECT_FALSE(fs::exists(folder / "a/.explica-lock"));
}

TEST(Framework, AKilledRunLeavesWholeFilesAndTheNextGivesTheSameBytes) {
  TemporaryFolder folder;
  const std::vector<std::string> line = {"phantom", "shell", "--size", "64", "--threads", "1"};
  const auto words = [&](const std::string& out) {
    auto all = line;
    all.insert(all.end(), {"--force", "--out", out});
    return all;
  };
  ASSERT_EQ(explica(words(folder / "undisturbed")).exitCode, 0);
  const auto expected = stableHashes(folder / "undisturbed");

  constexpr int kKills = 50;
  KillMoments moments(20261121);
  int killed = 0;
  for (int run = 0; killed < kKills; ++run) {
    ASSERT_LT(run, 10 * kKills) << "only " << killed << " runs were killed before their end";
    // A fresh folder, and one that is there: results appear in two different ways.
    const std::string out = folder / (run % 2 ? "fresh" : "there");
    if (run % 2 == 0) fs::create_directories(out);
    killed += moments.kill(words(out));
    if (fs::exists(out)) {
      for (const auto& entry : fs::directory_iterator(out)) {
        const std::string name = entry.path().filename().string();
        if (name.rfind(".explica-", 0) == 0) continue;
        if (expected.count(name)) {
          ASSERT_EQ(readText(entry.path()), readText(folder / "undisturbed/" + name)) << name;
        } else {
          ASSERT_NO_THROW((void)readJson(entry.path())) << name;
        }
      }
    }
    const auto again = explica(words(out));
    ASSERT_EQ(again.exitCode, 0) << again;
    ASSERT_EQ(stableHashes(out), expected) << "after run " << run;
    fs::remove_all(out);
  }
  EXPECT_EQ(folder.entries().size(), expected.size() + 3);  // the undisturbed run's, no remains
}

TEST(Framework, PrivateRecordsNameNoHostUserOrFolder) {
  TemporaryFolder folder;
  ASSERT_EQ(explica(shell(folder / "a", {"--private"})).exitCode, 0);
  const auto execution = readJson(folder / "a/provenance.json")["execution"];
  EXPECT_FALSE(execution["machine"].contains("host"));
  EXPECT_FALSE(execution["machine"].contains("user"));
  EXPECT_FALSE(execution.contains("directory"));
  EXPECT_EQ(readText(folder / "a/provenance.json").find(folder.path().string()), std::string::npos);
  EXPECT_EQ(explica({"verify", folder / "a"}).exitCode, 0);
}

TEST(Framework, QuietSaysNothingAndTheLogSaysAll) {
  TemporaryFolder folder;
  const auto result = explica(shell(folder / "a", {"--quiet", "--log", folder / "log.txt"}));
  EXPECT_EQ(result.exitCode, 0);
  EXPECT_TRUE(result.err.empty()) << result;
  EXPECT_TRUE(contains(readText(folder / "log.txt"), "done: results in"));
}

}  // namespace
}  // namespace explica::testing
