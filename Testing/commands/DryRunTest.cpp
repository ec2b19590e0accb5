// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// A dry run refuses what the run refuses before its first long step, and writes nothing.

#include "DescribedCommands.h"
#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <utility>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

/// People with a beating ventricle each; of the last one the second frame is damaged.
void writeHearts(const TemporaryFolder& folder, const std::vector<std::string>& people) {
  ASSERT_EQ(explica({"phantom", "ventricle", "--size", "64", "--spacing", "2", "--slice", "8",
                     "--frames", "2", "--out", folder / "beat"})
                .exitCode,
            0);
  for (const std::string& person : people) {
    fs::create_directories(folder / ("people/sub-" + person));
    for (const auto& [frame, name] : {std::pair{"0000", "ED"}, {"0001", "ES"}}) {
      fs::copy(
          folder / (std::string("beat/frame-") + frame + ".nii.gz"),
          folder / ("people/sub-" + person + "/sub-" + person + "_frame-" + name + "_dseg.nii.gz"));
    }
  }
}

/// The last line that begins with "error: ", without it.
std::string errorOf(const CommandResult& result) {
  const auto at = result.err.rfind("error: ");
  return at == std::string::npos ? std::string() : result.err.substr(at);
}

TEST(DryRun, OfARunRefusesWhatTheRunRefuses) {
  const TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "shell", "--size", "20", "--out", folder / "shell"}).exitCode, 0);
  writeText(folder / "lh.aparc.annot", "an annotation is no volume");
  const std::string labels = folder / "shell/labels.nii.gz";
  for (const std::string& input : {labels, folder / "shell/damaged.nii.gz"}) {
    writeText(folder / "shell/damaged.nii.gz", "damaged");
    const std::vector<std::string> words = {"run",     input,
                                            "--kind",  "labels",
                                            "--steps", "thickness,surface",
                                            "--atlas", folder / "lh.aparc.annot",
                                            "--out",   folder / "out"};
    const auto before = folder.entries();
    const auto dry = explica(words + std::vector<std::string>{"--dry-run"});
    EXPECT_EQ(dry.exitCode, 2) << dry;
    EXPECT_EQ(folder.entries(), before);
    EXPECT_EQ(errorOf(dry), errorOf(explica(words)));
  }
}

TEST(DryRun, OfHeartsChecksEveryPersonAndWritesNothing) {
  const TemporaryFolder folder;
  writeHearts(folder, {"01", "02"});
  const std::vector<std::string> words = {"study", "hearts", folder / "people", folder / "out",
                                          "--dry-run"};
  const auto before = folder.entries();
  const auto good = explica(words);
  EXPECT_EQ(good.exitCode, 0) << good;
  EXPECT_EQ(folder.entries(), before);

  writeText(folder / "people/sub-02/sub-02_frame-ES_dseg.nii.gz", "damaged");
  const auto one = explica(words);
  EXPECT_EQ(one.exitCode, 3) << one;
  EXPECT_TRUE(contains(one.err, "sub-02_frame-ES_dseg.nii.gz")) << one;
  writeText(folder / "people/sub-01/sub-01_frame-ED_dseg.nii.gz", "damaged");
  EXPECT_EQ(explica(words).exitCode, 2);
  EXPECT_EQ(folder.entries(), before);
}

TEST(DryRun, OfADataSetChecksEveryParticipantAndWritesNothing) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "data");
  writeText(folder / "data/dataset_description.json", R"({"Name": "a", "BIDSVersion": "1.8.0"})");
  ASSERT_EQ(explica({"phantom", "shell", "--size", "20", "--out", folder / "shell"}).exitCode, 0);
  for (const std::string person : {"01", "02"}) {
    const fs::path anat = folder / ("data/sub-" + person + "/anat");
    fs::create_directories(anat);
    const fs::path file = anat / ("sub-" + person + "_dseg.nii.gz");
    if (person == "01") fs::copy(folder / "shell/labels.nii.gz", file);
    if (person == "02") writeText(file, "damaged");
  }
  const auto before = folder.entries();
  const auto dry = explica({"bids", folder / "data", folder / "out", "participant", "--hemisphere",
                            "L", "--steps", "thickness", "--dry-run"});
  EXPECT_EQ(dry.exitCode, 3) << dry;
  EXPECT_TRUE(contains(dry.err, "sub-02_dseg.nii.gz")) << dry;
  EXPECT_EQ(folder.entries(), before);
}

/// A quick run of the command, as it is or with one file taken for another.
class DryRunOf : public PreparedRun {
 protected:
  /// Whether a dry run refuses, or says that an option has no effect; else the run refuses nothing.
  bool refuses(const std::vector<std::string>& words) {
    const auto before = folder_.entries();
    const auto dry = explica(words + std::vector<std::string>{"--dry-run", "--out", folder_ / "a"});
    EXPECT_EQ(folder_.entries(), before) << dry;
    if (dry.exitCode != 0 || dry.err.find("has no effect") != std::string::npos) return true;
    CommandSetting setting;
    setting.timeout = 20;  // what is refused is refused at once
    const auto run = explica(words + std::vector<std::string>{"--out", folder_ / "a"}, setting);
    EXPECT_TRUE(run.exitCode != 1 && run.exitCode != 2) << "the dry run had nothing against\n"
                                                        << run;
    fs::remove_all(folder_ / "a");
    return false;
  }

  /// Files of each kind: one of them is not what an argument asks for.
  std::vector<std::string> strangers() {
    writeText(folder_ / "damaged.nii.gz", "damaged");
    writeText(folder_ / "damaged.gii", "damaged");
    writeText(folder_ / "table.tsv", "a\tb\n1\t2\n");
    const TriangleMesh four = geometry::makeIcosphere(0, 10.0);
    io::writeSurface(folder_ / "four.surf.gii", four);
    io::writeGiftiShape(folder_ / "four.shape.gii", {{"a", "", Eigen::VectorXd::Ones(12)}},
                        "Other");
    return {folder_ / "damaged.nii.gz", folder_ / "damaged.gii", folder_ / "table.tsv",
            folder_ / "four.surf.gii", folder_ / "four.shape.gii"};
  }
};

TEST_P(DryRunOf, RefusesEachFileThatTheRunRefuses) {
  const auto others = strangers();
  for (std::string& word : words_) {
    if (!fs::is_regular_file(word)) continue;
    for (const std::string& other : others) {
      const std::string right = std::exchange(word, other);
      refuses(words_);
      word = right;
    }
  }
}

TEST_P(DryRunOf, RefusesADamagedFileForEachOption) {
  const std::string damaged = folder_ / "damaged.nii.gz";
  writeText(damaged, "damaged");
  for (const Json& command : describedCommands()) {
    const auto name = wordsOf(command);
    if (!std::equal(name.begin(), name.end(), words_.begin())) continue;
    for (const Json& parameter : command["parameters"]) {
      const std::string option = "--" + parameter["name"].get<std::string>();
      const bool given = std::find(words_.begin(), words_.end(), option) != words_.end();
      if (parameter["file"].is_null() || parameter["positional"].get<bool>() || given) continue;
      EXPECT_TRUE(refuses(words_ + std::vector<std::string>{option, damaged})) << option;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Quick, DryRunOf, ::testing::ValuesIn(quickRuns()),
                         [](const auto& row) { return row.param.name; });

TEST(StudyCheck, SaysWhoHasNoImage) {
  const TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "shell", "--size", "20", "--out", folder / "shell"}).exitCode, 0);
  fs::create_directories(folder / "01");
  fs::create_directories(folder / "02");
  fs::copy(folder / "shell/labels.nii.gz", folder / "01/aseg.nii.gz");
  writeText(folder / "study.json",
            R"({"hemispheres": ["L"], "input": "{subject}", "subjects": ["01", "02"]})");
  const auto empty = explica({"study", "check", folder / "study.json"});
  EXPECT_EQ(empty.exitCode, 2) << empty;
  EXPECT_TRUE(contains(empty.err, "sub-02")) << empty;
}

}  // namespace
}  // namespace explica::testing
