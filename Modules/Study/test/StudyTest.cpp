// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Study/BidsDataset.h"
#include "Explica/Study/Derivatives.h"
#include "Explica/Study/StudyTable.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace explica::study {
namespace {

namespace fs = std::filesystem;

class Study : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("explica-study-" + std::to_string(getpid()) + "-" +
               ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void put(const fs::path& file, const std::string& text = "{}") {
    fs::create_directories((folder_ / file).parent_path());
    writeTextFile(folder_ / file, text);
  }
  std::string get(const fs::path& file) {
    std::ifstream stream(folder_ / file);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }

  fs::path folder_;
};

TEST_F(Study, FindsWhatEachParticipantOffers) {
  put("dataset_description.json");
  put("sub-01/anat/sub-01_desc-aseg_dseg.nii.gz");
  put("sub-01/anat/sub-01_space-MNI152_desc-aparcaseg_dseg.nii.gz");  // of a template, not the head
  put("sub-02/ses-a/anat/sub-02_ses-a_desc-brain_T1w.nii.gz");
  put("sub-02/ses-a/anat/sub-02_ses-a_atlas-AAL_dseg.nii.gz");
  put("sub-02/ses-b/anat/sub-02_ses-b_T1w.nii.gz");
  put("sourcedata/freesurfer/sub-03/mri/ribbon.mgz");
  fs::create_directories(folder_ / "sub-03");
  const auto found = findParticipants(folder_);
  ASSERT_EQ(found.size(), 4u);
  EXPECT_EQ(found[0].input.filename(), "sub-01_desc-aseg_dseg.nii.gz");
  EXPECT_EQ(found[1].name(), "sub-02_ses-a");
  ASSERT_TRUE(found[1].atlas.has_value());
  EXPECT_EQ(found[1].atlas->filename(), "sub-02_ses-a_atlas-AAL_dseg.nii.gz");
  EXPECT_NE(found[2].problem.find("skull-stripped"), std::string::npos);
  EXPECT_EQ(found[3].input, folder_ / "sourcedata" / "freesurfer" / "sub-03");
}

TEST_F(Study, WantedParticipantsMustExist) {
  put("dataset_description.json");
  put("sub-01/anat/sub-01_dseg.nii.gz");
  put("sub-02/anat/sub-02_dseg.nii.gz");
  EXPECT_EQ(findParticipants(folder_, {"sub-02"}).size(), 1u);
  EXPECT_EQ(findParticipants(folder_, {"02"})[0].label, "02");
  EXPECT_THROW((void)findParticipants(folder_, {"07"}), InvalidInput);
  fs::remove(folder_ / "dataset_description.json");
  EXPECT_THROW((void)findParticipants(folder_), InvalidInput);
}

TEST_F(Study, ExportsCarryBidsNamesAndSidecars) {
  put("run/surface/pial.surf.gii", "surface");
  put("run/surface/summary.json", R"({"euler_characteristic": 2, "defects_corrected": 5})");
  put("run/unfold/unfolded.surf.gii", "unfolded");
  Participant participant;
  participant.label = "01";
  participant.session = "a";
  participant.input = folder_ / "labels.nii.gz";
  describeDerivatives(folder_ / "out", folder_, "1.2.3");
  const auto written = exportRun(folder_ / "run", folder_ / "out", participant, "L");
  EXPECT_EQ(written.size(), 2u);
  EXPECT_EQ(get("out/sub-01/ses-a/anat/sub-01_ses-a_hemi-L_pial.surf.gii"), "surface");
  const std::string sidecar = get("out/sub-01/ses-a/anat/sub-01_ses-a_hemi-L_pial.json");
  for (const char* key : {"Sources", "SpatialReference", "\"Units\": \"mm\"", "\"EulerNumber\": 2",
                          "\"NumberOfDefects\": 5"}) {
    EXPECT_NE(sidecar.find(key), std::string::npos) << key;
  }
  EXPECT_TRUE(fs::exists(folder_ / "out/sub-01/ses-a/anat" /
                         "sub-01_ses-a_hemi-L_desc-unfold_midthickness.surf.gii"));
  EXPECT_NE(get("out/dataset_description.json").find("\"DatasetType\": \"derivative\""),
            std::string::npos);
}

TEST_F(Study, FailedRunsAreRowsToo) {
  put("runs/sub-01_hemi-L/run.json", R"({"steps": [{"name": "surface", "state": "done"}]})");
  put("runs/sub-01_hemi-L/surface/summary.json",
      R"({"euler_characteristic": 2, "seconds": 3.5, "warnings": ["a"]})");
  put("runs/sub-02_hemi-R/problem.txt", "labels.nii.gz: label 2 absent\nmore");
  put("runs/sub-03_hemi-L/run.json", "{ damaged");
  const auto rows = collectRows(folder_);
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].state, "done");
  EXPECT_EQ(rows[1].state, "failed: labels.nii.gz: label 2 absent");
  EXPECT_EQ(rows[1].hemisphere, "R");
  EXPECT_EQ(rows[2].state.rfind("failed", 0), 0u);

  const std::string table = tableText(rows);
  EXPECT_EQ(table.substr(0, table.find('\n')),
            "participant_id\themisphere\tstate\tsurface.euler_characteristic");
  EXPECT_NE(table.find("sub-01\tL\tdone\t2\n"), std::string::npos);
  EXPECT_NE(table.find("label 2 absent\tn/a\n"), std::string::npos);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 4);
}

TEST_F(Study, PageEscapesAndMarks) {
  StudyRow row;
  row.participant = "sub-<x>";
  row.hemisphere = "L";
  row.state = "failed: a & b";
  row.report = "runs/a/report.html";
  const std::string page = indexPage({row}, "Title");
  EXPECT_NE(page.find("sub-&lt;x&gt;"), std::string::npos);
  EXPECT_NE(page.find("a &amp; b"), std::string::npos);
  EXPECT_NE(page.find("class=\"flag\""), std::string::npos);
  EXPECT_NE(page.find("href=\"runs/a/report.html\""), std::string::npos);
}

}  // namespace
}  // namespace explica::study
