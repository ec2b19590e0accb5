// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// A small BIDS data set, participant by participant: one good, one with nothing to start from.

#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

class Bids : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(explica({"phantom", "cortex", "--size", "40", "--out", folder_ / "phantom"}).exitCode,
              0);
    fs::create_directories(folder_ / "data/sub-01/anat");
    fs::create_directories(folder_ / "data/sub-02/anat");
    fs::copy_file(folder_ / "phantom/labels.nii.gz",
                  folder_ / "data/sub-01/anat/sub-01_dseg.nii.gz");
    writeText(folder_ / "data/dataset_description.json",
              R"({"Name": "a", "BIDSVersion": "1.8.0"})");
  }

  CommandResult participants(const std::string& steps = "thickness,surface") {
    return explica({"bids", folder_ / "data", folder_ / "out", "participant", "--hemisphere", "L",
                    "--steps", steps, "--surface.faces", "3000"});
  }

  TemporaryFolder folder_;
};

TEST_F(Bids, GoodParticipantsAreExportedAndFailedOnesAreRows) {
  const CommandResult run = participants();
  ASSERT_EQ(run.exitCode, 3) << run;  // one failed, all that could be done is done
  EXPECT_NE(run.err.find("1 of 2 hemispheres failed: sub-02_hemi-L"), std::string::npos) << run;
  EXPECT_NE(run.err.find("sub-02_hemi-L"), std::string::npos);
  const fs::path anat = fs::path(folder_ / "out/sub-01/anat");
  for (const char* suffix : {"_white.surf.gii", "_pial.surf.gii", "_thickness.shape.gii"}) {
    EXPECT_TRUE(fs::exists(anat / ("sub-01_hemi-L" + std::string(suffix)))) << suffix;
  }
  EXPECT_EQ(readJson(anat / "sub-01_hemi-L_white.json")["EulerNumber"], 2);
  EXPECT_EQ(readJson(folder_ / "out/dataset_description.json")["DatasetType"], "derivative");

  const CommandResult group = explica({"bids", folder_ / "data", folder_ / "out", "group"});
  ASSERT_EQ(group.exitCode, 0) << group;
  const std::string table = readText(folder_ / "out/study.tsv");
  EXPECT_NE(table.find("sub-01\tL\tdone\t"), std::string::npos);
  EXPECT_NE(table.find("sub-02\tL\tfailed: "), std::string::npos);
  EXPECT_NE(readText(folder_ / "out/index.html").find("1 of 2 hemispheres"), std::string::npos);
}

TEST_F(Bids, IsADerivativeThatMovesAndThatReadersFindTheirWayIn) {
  ASSERT_EQ(participants("thickness,surface,report").exitCode, 3);
  const auto description = readJson(folder_ / "out/dataset_description.json");
  EXPECT_EQ(description["SourceDatasets"][0]["URL"], "bids:raw:.");
  EXPECT_EQ(description["DatasetLinks"]["raw"], "../data");
  const std::string page = readText(folder_ / "out/sub-01.html");
  EXPECT_NE(page.find("runs/sub-01_hemi-L/report.html"), std::string::npos);
  EXPECT_EQ(page.find("sub-02"), std::string::npos);
  EXPECT_TRUE(fs::exists(folder_ / "out/sub-02.html"));
  EXPECT_NE(readText(folder_ / "out/README.md").find("sub-XX.html"), std::string::npos);
  const std::string ignored = readText(folder_ / "out/.bidsignore");
  EXPECT_NE(ignored.find("*_white.*\n"), std::string::npos) << ignored;
  for (const char* known : {"hemi", "dseg", "probseg", "brain_mask"}) {
    EXPECT_EQ(ignored.find(known), std::string::npos) << ignored;
  }
}

TEST_F(Bids, TheValidatorFindsNoError) {
  const char* validator = std::getenv("EXPLICA_BIDS_VALIDATOR");
  if (!validator || !*validator)
    GTEST_SKIP() << "skipped: EXPLICA_BIDS_VALIDATOR names no folder of the package";
  ASSERT_EQ(participants().exitCode, 3);
  ASSERT_EQ(explica({"bids", folder_ / "data", folder_ / "out", "group"}).exitCode, 0);
  const std::string script = EXPLICA_SOURCE_DIR "/Testing/commands/bids_validator.mjs";
  const CommandResult judged = runProgram({"node", script, validator, folder_ / "out"});
  EXPECT_EQ(judged.exitCode, 0) << judged;
  EXPECT_NE(judged.out.find("0 errors"), std::string::npos) << judged;
  // It can fail.
  writeText(folder_ / "out/sub-01/anat/sub-01_hemi-L_nonsense.nii.gz", "");
  EXPECT_EQ(runProgram({"node", script, validator, folder_ / "out"}).exitCode, 1);
}

TEST_F(Bids, UnchangedStepsAreKeptByContent) {
  ASSERT_EQ(participants().exitCode, 3);
  const fs::path record = folder_ / "out/runs/sub-01_hemi-L/surface/provenance.json";
  const std::string before = readText(record);
  fs::last_write_time(folder_ / "data/sub-01/anat/sub-01_dseg.nii.gz",
                      fs::file_time_type::clock::now());
  ASSERT_EQ(participants().exitCode, 3);
  EXPECT_EQ(readText(record), before);
}

TEST_F(Bids, AnImageOfOneHeadIsNotGivenToSeveral) {
  for (const char* option : {"--t2", "--segment.mask", "--surface.image"}) {
    const CommandResult run =
        explica({"bids", folder_ / "data", folder_ / "out", "participant", "--hemisphere", "L",
                 option, folder_ / "data/sub-01/anat/sub-01_dseg.nii.gz", "--dry-run"});
    EXPECT_EQ(run.exitCode, 1) << run;
    EXPECT_NE(run.err.find(option), std::string::npos) << run;
    EXPECT_NE(run.err.find("--participant-label"), std::string::npos) << run;
  }
}

TEST_F(Bids, NoDataSetIsRefused) {
  fs::remove(folder_ / "data/dataset_description.json");
  const CommandResult run = participants();
  EXPECT_EQ(run.exitCode, 2) << run;
  EXPECT_NE(run.err.find("dataset_description.json"), std::string::npos);
}

}  // namespace
}  // namespace explica::testing
