// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// The example study file, and what studies must keep and do again.

#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <sstream>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

class Study : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(explica({"phantom", "cortex", "--size", "40", "--depth", "0.1", "--waves", "3",
                       "--out", folder_ / "phantom"})
                  .exitCode,
              0);
    fs::copy_file(fs::path(EXPLICA_SOURCE_DIR) / "ExampleData/study/study.yaml",
                  folder_ / "study.yaml");
  }

  CommandResult participant(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"study", "participant", folder_ / "study.yaml",
                                      folder_ / "out"};
    words.insert(words.end(), more.begin(), more.end());
    return explica(words);
  }
  std::string todo() {
    return explica({"study", "list", folder_ / "study.yaml", folder_ / "out", "--todo"}).out;
  }
  /// A word of the table: the column's, in the row of that subject.
  std::string cell(const std::string& subject, const std::string& column) {
    EXPECT_EQ(explica({"study", "group", folder_ / "study.yaml", folder_ / "out"}).exitCode, 0);
    std::istringstream table(readText(folder_ / "out/study.tsv"));
    std::vector<std::string> names;
    for (std::string line; std::getline(table, line);) {
      std::vector<std::string> words;
      std::istringstream cells(line);
      for (std::string word; std::getline(cells, word, '\t');) words.push_back(word);
      if (names.empty()) names = words;
      if (words.at(0) != subject) continue;
      for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i] == column) return words.at(i);
      }
    }
    return "absent";
  }

  TemporaryFolder folder_;
};

TEST_F(Study, TheExampleGoesFromFileToTable) {
  const auto checked = explica({"study", "check", folder_ / "study.yaml"});
  ASSERT_EQ(checked.exitCode, 0) << checked;
  EXPECT_NE(checked.err.find("3 subjects, 3 runs"), std::string::npos) << checked;
  EXPECT_EQ(explica({"study", "list", folder_ / "study.yaml"}).out, "01\n02\n03\n");
  EXPECT_EQ(todo(), "01\n02\n03\n");

  const auto made = participant({"--participant-label", "01", "sub-03"});
  EXPECT_TRUE(made.exitCode == 0 || made.exitCode == 3) << made;
  EXPECT_EQ(todo(), "02\n");
  EXPECT_EQ(cell("sub-02", "state"), "not begun");
  EXPECT_EQ(cell("sub-01", "surface.euler_characteristic"), "2");
  EXPECT_EQ(cell("sub-01", "state").rfind("stopped early (unfold)", 0), 0u);
  // The group's viewpoint and the subject's own.
  const fs::path runs = folder_ / "out/runs";
  const auto optionsOf = [&](const std::string& run) {
    return readJson(runs / run / "unfold/provenance.json")["options"];
  };
  EXPECT_EQ(optionsOf("sub-01_hemi-L_region-crown")["viewpoint"],
            nlohmann::ordered_json::parse("[[0, 0, 1000]]"));
  EXPECT_EQ(optionsOf("sub-03_hemi-L_region-crown")["viewpoint"],
            nlohmann::ordered_json::parse("[[100, 0, 900]]"));
}

TEST_F(Study, ADryRunOfItsParticipantsChecksEachAndWritesNothing) {
  const auto before = folder_.entries();
  const auto good = participant({"--dry-run"});
  EXPECT_EQ(good.exitCode, 0) << good;
  EXPECT_EQ(folder_.entries(), before);
  writeText(folder_ / "phantom/labels.nii.gz", "damaged");
  const auto none = participant({"--dry-run"});
  EXPECT_EQ(none.exitCode, 2) << none;
  EXPECT_NE(none.err.find("labels.nii.gz"), std::string::npos) << none;
  EXPECT_EQ(none.err.find("problem.txt"), std::string::npos) << none;
  EXPECT_EQ(folder_.entries(), before);
}

TEST_F(Study, OnlyWhatHasChangedByContentIsDoneAgain) {
  const auto first = participant();
  ASSERT_TRUE(first.exitCode == 0 || first.exitCode == 3) << first;
  EXPECT_EQ(todo(), "");
  const auto before = stableHashes(folder_ / "out/runs");

  // A new date and another number of threads are no change.
  fs::last_write_time(folder_ / "phantom/labels.nii.gz", fs::file_time_type::clock::now());
  EXPECT_EQ(todo(), "");
  const auto again = participant({"--threads", "1"});
  EXPECT_EQ(again.err.find("thickness: 1"), std::string::npos) << again;
  for (const char* step : {"thickness", "surface", "unfold"}) {
    EXPECT_NE(again.err.find(std::string(step) + ": kept"), std::string::npos) << again;
  }
  EXPECT_EQ(stableHashes(folder_ / "out/runs"), before);

  std::string text = readText(folder_ / "study.yaml");
  text.replace(text.find("lambda: 0.7"), 11, "lambda: 0.9");
  writeText(folder_ / "study.yaml", text);
  EXPECT_EQ(todo(), "02\n");
}

TEST_F(Study, RegionsOfAHemisphereShareItsSurfaces) {
  writeText(folder_ / "study.yaml",
            "input: phantom/labels.nii.gz\nhemispheres: [L]\nsubjects: [1]\n"
            "parameters: {surface.faces: 3000, unfold: {max-iterations: 1, radius: 8}}\n"
            "regions: {top: {direction: [0, 0, 1]}, front: {direction: [0, 1, 0]}}\n");
  const auto made = participant();
  ASSERT_TRUE(made.exitCode == 0 || made.exitCode == 3) << made;
  EXPECT_NE(made.err.find("sub-1_hemi-L_region-front: surface: kept"), std::string::npos) << made;
  const fs::path runs = folder_ / "out/runs";
  EXPECT_EQ(stableHashes(runs / "sub-1_hemi-L_region-top/surface"),
            stableHashes(runs / "sub-1_hemi-L_region-front/surface"));
  for (const char* run : {"sub-1_hemi-L_region-top", "sub-1_hemi-L_region-front"}) {
    const auto verified = explica({"verify", "--deep", runs / run / "unfold"});
    EXPECT_EQ(verified.exitCode, 0) << verified;
  }
  EXPECT_EQ(todo(), "");
}

TEST_F(Study, ABrokenInputIsARowAndStaysToDo) {
  writeText(folder_ / "broken.nii.gz", "no image");
  writeText(folder_ / "study.yaml",
            "hemispheres: [L]\nparameters: {surface.faces: 3000, steps: [thickness]}\n"
            "subjects:\n  a: {input: broken.nii.gz}\n  b: {input: phantom/labels.nii.gz}\n"
            "  c: {input: absent.nii.gz}\n");
  const auto checked = explica({"study", "check", folder_ / "study.yaml"});
  EXPECT_EQ(checked.exitCode, 2) << checked;
  EXPECT_NE(checked.err.find("line 6, subjects.c: "), std::string::npos) << checked;
  const auto made = participant();
  EXPECT_EQ(made.exitCode, 3) << made;
  EXPECT_NE(made.err.find("2 of 3 runs failed (sub-a_hemi-L, sub-c_hemi-L)"), std::string::npos);
  EXPECT_NE(made.err.find("2 of 3 runs failed"), std::string::npos) << made;
  EXPECT_EQ(todo(), "a\nc\n");
  EXPECT_EQ(cell("sub-b", "state"), "done");
  EXPECT_NE(cell("sub-a", "state").find("broken.nii.gz"), std::string::npos);
  EXPECT_NE(cell("sub-c", "state").find("absent.nii.gz does not exist"), std::string::npos);
}

TEST_F(Study, ImplausibleNumbersEndWithThreeAndAreDone) {
  ASSERT_EQ(explica({"phantom", "cortex", "--size", "64", "--depth", "0.1", "--waves", "3",
                     "--thickness", "6", "--out", folder_ / "thick"})
                .exitCode,
            0);
  writeText(folder_ / "study.yaml",
            "hemispheres: [L]\nparameters: {surface.faces: 1000, steps: [surface]}\n"
            "subjects:\n  a: {input: phantom/labels.nii.gz}\n  b: {input: thick/labels.nii.gz}\n");
  const auto made = participant();
  EXPECT_EQ(made.exitCode, 3) << made;
  EXPECT_EQ(todo(), "") << made;
  EXPECT_EQ(cell("sub-a", "state"), "done");
  EXPECT_EQ(cell("sub-b", "state").rfind("implausible", 0), 0u) << cell("sub-b", "state");
  EXPECT_EQ(participant().exitCode, 3) << "what was kept is as implausible as before";
}

TEST_F(Study, AFaultInTheFileStopsBeforeAnythingRuns) {
  writeText(folder_ / "study.yaml",
            "input: phantom/labels.nii.gz\nsubjects: [1]\nparameters: {unfold: {radus: 3}}\n");
  const auto made = participant();
  EXPECT_EQ(made.exitCode, 2) << made;
  EXPECT_NE(made.err.find("line 3, parameters.unfold.radus: unknown key; did you mean 'radius'?"),
            std::string::npos)
      << made;
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

}  // namespace
}  // namespace explica::testing
