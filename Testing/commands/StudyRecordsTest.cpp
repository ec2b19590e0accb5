// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// From a study's final files back to its inputs, in our words and in those of others.

#include "SmallStudy.h"

#include <gtest/gtest.h>
#include <unistd.h>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

/// True if the word stands in the text, not within a longer word.
bool hasWord(const std::string& text, const std::string& word) {
  const auto isPart = [](unsigned char c) { return std::isalnum(c) != 0; };
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const auto end = at + word.size();
    if ((at == 0 || !isPart(text[at - 1])) && (end == text.size() || !isPart(text[end]))) {
      return true;
    }
  }
  return false;
}

class StudyRecords : public ::testing::Test {
 protected:
  TemporaryFolder folder_;
};

TEST_F(StudyRecords, HistoryLeadsFromEveryFinalFileToTheInput) {
  const SmallStudy study(folder_.path(), {"01"});
  ASSERT_EQ(explica(study.participants(study.out())).exitCode, 0);
  int followed = 0;
  for (const auto& entry : fs::recursive_directory_iterator(study.out() + "/sub-01")) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_regular_file() || entry.path().extension() == ".json") continue;
    const CommandResult history = explica({"history", entry.path().string()});
    ASSERT_EQ(history.exitCode, 0) << name << history;
    EXPECT_NE(history.out.find("sub-01_dseg.nii.gz"), std::string::npos) << name << history;
    EXPECT_EQ(history.out.find("CHANGED"), std::string::npos) << name << history;
    ++followed;
  }
  EXPECT_GE(followed, 8);
  EXPECT_EQ(explica({"verify", study.out() + "/runs/sub-01_hemi-L/surface", "--deep"}).exitCode, 0);
  fs::resize_file(study.labels("01"), 100);
  EXPECT_EQ(explica({"verify", study.out() + "/runs/sub-01_hemi-L/surface", "--deep"}).exitCode, 2);
}

TEST_F(StudyRecords, ExportsHoldBeforeAnIndependentCheck) {
  const SmallStudy study(folder_.path(), {"01", "02"});
  fs::resize_file(study.labels("02"), 100);
  ASSERT_EQ(explica(study.participants(study.out())).exitCode, 3);
  ASSERT_EQ(explica(study.group(study.out())).exitCode, 0);
  const CommandResult prov =
      explica({"verify", study.out() + "/runs/sub-01_hemi-L/surface", "--prov-json", "--deep"});
  ASSERT_EQ(prov.exitCode, 0) << prov;
  writeText(folder_ / "prov.json", prov.out);
  const CommandResult checked =
      runProgram({EXPLICA_PYTHON, EXPLICA_SOURCE_DIR "/Testing/commands/check_study.py",
                  study.out(), folder_ / "prov.json"});
  EXPECT_EQ(checked.exitCode, 0) << checked;

  // The check can fail: a changed file, a sidecar that points nowhere.
  writeText(study.out() + "/descriptions.tsv", "changed");
  EXPECT_NE(runProgram({EXPLICA_PYTHON, EXPLICA_SOURCE_DIR "/Testing/commands/check_study.py",
                        study.out(), folder_ / "prov.json"})
                .exitCode,
            0);
}

TEST_F(StudyRecords, PrivateStudiesNameNoHostUserOrFolder) {
  fs::create_directories(folder_ / "home/janedoe");
  const SmallStudy study(folder_ / "home/janedoe", {"01", "02"});
  fs::resize_file(study.labels("02"), 100);
  const std::string host = "scanner17";
  const bool ownHost = runProgram({"unshare", "--uts", "hostname", host}).exitCode == 0;
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.begin(), EXPLICA_EXECUTABLE);
    words.emplace_back("--private");
    if (ownHost) {
      words.insert(words.begin(),
                   {"unshare", "--uts", "sh", "-c", "hostname " + host + " && exec \"$@\"", "sh"});
    }
    CommandSetting setting;
    setting.environment = {{"USER", "janedoe"}, {"LOGNAME", "janedoe"}};
    return runProgram(words, setting);
  };
  const CommandResult participants =
      run(study.participants(study.out(), {"--steps", "thickness,surface,report"}));
  ASSERT_EQ(participants.exitCode, 3) << participants;
  ASSERT_EQ(run(study.group(study.out())).exitCode, 0);
  int read = 0;
  for (const auto& entry : fs::recursive_directory_iterator(study.out())) {
    if (!entry.is_regular_file()) continue;
    const std::string text = readText(entry.path());
    EXPECT_FALSE(hasWord(text, "janedoe")) << entry.path();
    EXPECT_FALSE(hasWord(text, host)) << entry.path();
    EXPECT_EQ(text.find(folder_.path().string()), std::string::npos) << entry.path();
    ++read;
  }
  EXPECT_GT(read, 40);
  if (!ownHost) GTEST_SKIP() << "skipped: this user may not name a host; users and folders checked";
}

}  // namespace
}  // namespace explica::testing
