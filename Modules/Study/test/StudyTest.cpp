// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Provenance/Doubts.h"
#include "Explica/Study/BidsDataset.h"
#include "Explica/Study/Derivatives.h"
#include "Explica/Study/StudyPage.h"
#include "Explica/Study/StudyTable.h"
#include "Explica/Study/SubjectFiles.h"

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
  EXPECT_EQ(found[0].input, folder_ / "sub-01/anat");
  EXPECT_EQ(found[1].name(), "sub-02_ses-a");
  EXPECT_EQ(found[1].input, folder_ / "sub-02/ses-a/anat");
  EXPECT_EQ(found[2].problem, "") << "a T1 as it comes from the scanner will do";
  EXPECT_EQ(findSubjectFiles(found[2].input).t1,
            folder_ / "sub-02/ses-b/anat/sub-02_ses-b_T1w.nii.gz");
  EXPECT_EQ(found[3].input, folder_ / "sourcedata" / "freesurfer" / "sub-03");
}

TEST_F(Study, ASessionWithoutAnatomyIsNoFailureBesideOthersWithIt) {
  put("dataset_description.json");
  put("sub-01/ses-a/anat/sub-01_ses-a_T1w.nii.gz");
  put("sub-01/ses-b/func/sub-01_ses-b_task-rest_bold.nii.gz");
  put("sub-02/ses-a/dwi/sub-02_ses-a_dwi.nii.gz");
  put("sourcedata/freesurfer/sub-01/mri/ribbon.mgz");
  const auto found = findParticipants(folder_);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].name(), "sub-01_ses-a");
  EXPECT_EQ(found[1].name(), "sub-02");
  EXPECT_NE(found[1].problem, "");
}

TEST_F(Study, WhatWasMadeOfAllSessionsIsOnePersons) {
  put("dataset_description.json");
  put("sub-01/anat/sub-01_desc-aseg_dseg.nii.gz");
  put("sub-01/ses-a/func/sub-01_ses-a_task-rest_bold.nii.gz");
  put("sub-01/ses-b/func/sub-01_ses-b_task-rest_bold.nii.gz");
  put("sub-02/ses-a/func/sub-02_ses-a_task-rest_bold.nii.gz");
  put("sourcedata/freesurfer/sub-02/mri/ribbon.mgz");
  const auto found = findParticipants(folder_);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].name(), "sub-01");
  EXPECT_EQ(found[0].input, folder_ / "sub-01/anat");
  EXPECT_EQ(found[1].name(), "sub-02");
  EXPECT_EQ(found[1].input, folder_ / "sourcedata/freesurfer/sub-02");
}

TEST_F(Study, SessionsDoNotShareAPersonsFreeSurferSubject) {
  put("dataset_description.json");
  for (const char* session : {"sub-01/ses-a/anat/sub-01_ses-a", "sub-01/ses-b/anat/sub-01_ses-b",
                              "sub-02/ses-a/anat/sub-02_ses-a"}) {
    put(std::string(session) + "_T1w.nii.gz");
  }
  for (const char* made : {"sub-01", "sub-01_ses-b", "sub-02"}) {
    put("sourcedata/freesurfer/" + std::string(made) + "/mri/ribbon.mgz");
  }
  const auto found = findParticipants(folder_);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].input, folder_ / "sub-01/ses-a/anat");
  EXPECT_EQ(found[1].input, folder_ / "sourcedata/freesurfer/sub-01_ses-b");
  EXPECT_EQ(found[2].input, folder_ / "sourcedata/freesurfer/sub-02");
}

TEST_F(Study, OfSeveralImagesTheFirstWithoutContrastAgentIsUsedAndNamed) {
  for (const char* file : {"ce-gadolinium_T1w.nii.gz", "run-1_T1w.nii.gz", "run-2_T1w.nii.gz"}) {
    put("sub-01/anat/sub-01_" + std::string(file));
  }
  const SubjectFiles files = findSubjectFiles(folder_ / "sub-01");
  EXPECT_EQ(files.t1, folder_ / "sub-01/anat/sub-01_run-1_T1w.nii.gz");
  ASSERT_EQ(files.remarks.size(), 1u);
  EXPECT_EQ(files.remarks[0], "of 3 T1 images sub-01_run-1_T1w.nii.gz is used");
}

TEST_F(Study, FindsTheFilesOfAFreeSurferSubject) {
  put("bert/mri/ribbon.mgz");
  put("bert/mri/aparc+aseg.mgz");
  put("bert/surf/lh.white");
  put("bert/surf/lh.pial");
  put("bert/label/lh.aparc.annot");
  put("bert/surf/rh.white");
  const SubjectFiles files = findSubjectFiles(folder_ / "bert");
  EXPECT_EQ(files.layout, SubjectLayout::FreeSurfer);
  EXPECT_EQ(files.labels, folder_ / "bert/mri/ribbon.mgz");
  EXPECT_EQ(files.atlas, folder_ / "bert/mri/aparc+aseg.mgz");
  EXPECT_FALSE(files.image);
  EXPECT_EQ(files.left.pial, folder_ / "bert/surf/lh.pial");
  EXPECT_EQ(files.left.parcellation, folder_ / "bert/label/lh.aparc.annot");
  EXPECT_FALSE(files.right.white);  // alone it is of no use
  ASSERT_EQ(files.remarks.size(), 1u);
  EXPECT_EQ(files.remarks[0], "surf/rh.pial is not there: surf/rh.white alone is not used");
  fs::remove(folder_ / "bert/mri/ribbon.mgz");
  put("bert/mri/aseg.mgz");
  EXPECT_EQ(findSubjectFiles(folder_ / "bert").labels, folder_ / "bert/mri/aseg.mgz");
  put("bert/mri/norm.mgz");
  EXPECT_EQ(findSubjectFiles(folder_ / "bert").image, folder_ / "bert/mri/norm.mgz");
  put("bert/mri/brain.mgz");
  EXPECT_EQ(findSubjectFiles(folder_ / "bert").image, folder_ / "bert/mri/brain.mgz");
}

TEST_F(Study, FindsTheFilesOfFmriPrep) {
  for (const char* file :
       {"desc-preproc_T1w.nii.gz", "desc-brain_mask.nii.gz", "dseg.nii.gz",
        "label-GM_probseg.nii.gz", "desc-aseg_dseg.nii.gz", "desc-aparcaseg_dseg.nii.gz",
        "hemi-L_white.surf.gii", "hemi-L_pial.surf.gii", "hemi-L_midthickness.surf.gii",
        "hemi-R_smoothwm.surf.gii", "hemi-R_pial.surf.gii",
        "space-MNI152NLin2009cAsym_dseg.nii.gz"}) {
    put("sub-01/anat/sub-01_" + std::string(file));
  }
  for (const char* place : {"sub-01", "sub-01/anat"}) {
    const SubjectFiles files = findSubjectFiles(folder_ / place);
    EXPECT_EQ(files.layout, SubjectLayout::Bids);
    EXPECT_EQ(files.labels, folder_ / "sub-01/anat/sub-01_desc-aseg_dseg.nii.gz");
    EXPECT_EQ(files.atlas, folder_ / "sub-01/anat/sub-01_desc-aparcaseg_dseg.nii.gz");
    EXPECT_EQ(files.left.mid, folder_ / "sub-01/anat/sub-01_hemi-L_midthickness.surf.gii");
    EXPECT_EQ(files.right.white, folder_ / "sub-01/anat/sub-01_hemi-R_smoothwm.surf.gii");
  }
  // Without FreeSurfer: three classes, of one hemisphere or refused by who uses them.
  for (const char* file : {"desc-aseg_dseg.nii.gz", "desc-aparcaseg_dseg.nii.gz"}) {
    fs::remove(folder_ / "sub-01/anat" / ("sub-01_" + std::string(file)));
  }
  EXPECT_EQ(findSubjectFiles(folder_ / "sub-01").labels,
            folder_ / "sub-01/anat/sub-01_dseg.nii.gz");
}

TEST_F(Study, AFolderWithNothingInItIsRefused) {
  for (const char* place : {"bert/mri/nu.mgz", "sub-01/anat/sub-01_T2w.nii.gz", "letters/a.txt",
                            "sub-02/ses-a/anat/sub-02_ses-a_dseg.nii.gz"}) {
    put(place);
    const fs::path folder = folder_ / *fs::path(place).begin();
    try {
      (void)findSubjectFiles(folder);
      ADD_FAILURE() << place;
    } catch (const InvalidInput& fault) {
      EXPECT_NE(std::string(fault.what()).find(folder.string()), std::string::npos) << fault.what();
    }
  }
  EXPECT_NO_THROW((void)findSubjectFiles(folder_ / "sub-02/ses-a"));
}

TEST_F(Study, WantedParticipantsMustExist) {
  put("dataset_description.json");
  put("sub-01/anat/sub-01_dseg.nii.gz");
  put("sub-02/anat/sub-02_dseg.nii.gz");
  EXPECT_EQ(findParticipants(folder_, {"sub-02"}).size(), 1u);
  EXPECT_EQ(findParticipants(folder_, {"02"})[0].label, "02");
  EXPECT_THROW((void)findParticipants(folder_, {"07"}), InvalidInput);
  for (const char* broken : {"{not json", "[]"}) {
    put("dataset_description.json", broken);
    try {
      (void)findParticipants(folder_);
      ADD_FAILURE() << broken;
    } catch (const std::runtime_error& fault) {
      EXPECT_NE(std::string(fault.what()).find("dataset_description.json"), std::string::npos);
    }
  }
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
  put("labels.nii.gz");
  participant.input = folder_ / "labels.nii.gz";
  const DerivativeOrigin origin{folder_, true};
  describeDerivatives(folder_ / "out", origin, "1.2.3");
  const auto written = exportRun(folder_ / "run", folder_ / "out", participant, "L", origin);
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
  EXPECT_NE(get("out/dataset_description.json").find("\"raw\": \"..\""), std::string::npos);

  // What a run no longer has goes, with its sidecar.
  fs::remove(folder_ / "run/surface/pial.surf.gii");
  exportRun(folder_ / "run", folder_ / "out", participant, "L", origin);
  EXPECT_FALSE(fs::exists(folder_ / "out/sub-01/ses-a/anat/sub-01_ses-a_hemi-L_pial.surf.gii"));
  EXPECT_FALSE(fs::exists(folder_ / "out/sub-01/ses-a/anat/sub-01_ses-a_hemi-L_pial.json"));
  EXPECT_TRUE(fs::exists(folder_ / "out/sub-01/ses-a/anat" /
                         "sub-01_ses-a_hemi-L_desc-unfold_midthickness.surf.gii"));
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
            "participant_id\themisphere\tstate\tflags\tsurface.euler_characteristic");
  EXPECT_NE(table.find("sub-01\tL\tdone\tn/a\t2\n"), std::string::npos);
  EXPECT_NE(table.find("label 2 absent\tstate: failed\tn/a\n"), std::string::npos);
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 4);
}

TEST_F(Study, RegionsBecomeColumnsAndPatchesRows) {
  for (const char* patch : {"hand", "face"}) {
    const fs::path run = std::string("runs/sub-01_hemi-L_region-") + patch;
    put(run / "run.json", R"({"steps": [{"name": "surface", "state": "done"}]})");
    put(run / "surface/regions.tsv",
        "index\tname\tvertices\tarea_white_mm2\tvolume_mm3\tthickness_mean_mm\tthickness_sd_mm\n"
        "1025\tprecuneus\t90\t88.5\t200\t2.25\t0.5\n");
    put(run / "regions/regions.tsv",
        "person\themisphere\tatlas\tregion\tmeasure\tvalue\tunit\n"
        "sub-01\tL\taparc\tcuneus\tthickness_mean\t2.5\tmm\n");
  }
  auto rows = collectRows(folder_);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].hemisphere, "L");
  EXPECT_EQ(rows[1].region, "hand");
  EXPECT_EQ(rows[0].values.at("region.precuneus"), "2.25");
  rows.resize(1);
  rows[0].values["participant.age"] = "31";
  EXPECT_EQ(tableText(rows),
            "participant_id\themisphere\tregion\tstate\tflags\tparticipant.age\tregion.precuneus\t"
            "region.precuneus.area\tregion.precuneus.sd\tregion.precuneus.volume\n"
            "sub-01\tL\tface\tdone\tn/a\t31\t2.25\t88.5\t0.5\t200\n");
}

TEST_F(Study, RegionsAreALongTableToo) {
  for (const char* patch : {"face", "hand"}) {  // whose regions are the same
    const fs::path run = std::string("runs/sub-01_hemi-L_region-") + patch;
    put(run / "run.json", R"({"steps": [{"name": "surface", "state": "done"}]})");
    put(run / "surface/regions.tsv", "index\tname\tarea_white_mm2\n1025\tprecuneus\t88.5\n");
    put(run / "regions/regions.tsv",
        "person\themisphere\tatlas\tregion\tmeasure\tvalue\tunit\n"
        "sub-01\tL\taparc\tcuneus\tthickness_mean\t2.5\tmm\n");
  }
  auto rows = collectRows(folder_);
  for (StudyRow& row : rows) row.values["participant.age"] = "31";
  EXPECT_EQ(
      regionsText(rows),
      "participant_id\themisphere\tatlas\tregion\tmeasure\tvalue\tunit\tstate\tparticipant.age\n"
      "sub-01\tL\tsurface\tprecuneus\tarea\t88.5\tmm^2\tdone\t31\n"
      "sub-01\tL\ttemplate aparc\tcuneus\tthickness_mean\t2.5\tmm\tdone\t31\n");
}

TEST_F(Study, HowAStepWentIsATableOfItsOwn) {
  StudyRow row{"sub-01", "L", "", "done", {}, {}, {}, {}};
  row.values = {{"surface.area_white", "90000"}, {"surface.points_moved", "7"}};
  EXPECT_EQ(tableText({row}),
            "participant_id\themisphere\tstate\tflags\tsurface.area_white\nsub-01\tL\tdone\tn/"
            "a\t90000\n");
  EXPECT_EQ(internalsText({row}),
            "participant_id\themisphere\tstate\tsurface.points_moved\nsub-01\tL\tdone\t7\n");
}

TEST_F(Study, ReadsWhatAPersonHasRated) {
  const auto rated = [](const char* first, const char* second) {
    return std::string(R"({"format": "explica-rating", "ratings": [{"rating": )") + first +
           R"(}, {"rating": )" + second + "}, {\"rating\": null}]}";
  };
  for (const char* person : {"01", "02", "03", "04"}) {
    put(std::string("runs/sub-") + person + "_hemi-L/run.json",
        R"({"steps": [{"name": "surface", "state": "done"}]})");
  }
  put("ratings/sub-01_hemi-L_rating.json", rated(R"("wrong")", R"("right")"));
  put("runs/sub-02_hemi-L/sub-02_hemi-L_rating.json", rated(R"("right")", R"("unsure")"));
  put("ratings/sub-03_hemi-L_rating.json", "{}");
  const auto rows = collectRows(folder_);
  EXPECT_EQ(rows[0].state, "implausible (rating): places rated wrong: 1");
  EXPECT_EQ(rows[0].values.at("rating.right"), "1");
  EXPECT_EQ(rows[1].state, "done");
  EXPECT_EQ(rows[1].values.at("rating.unsure"), "1");
  EXPECT_NE(rows[2].state.find("is not a rating"), std::string::npos) << rows[2].state;
  EXPECT_EQ(rows[3].values.count("rating.right"), 0u);
}

TEST_F(Study, OutliersAndBadSurfacesAreFlagged) {
  std::vector<StudyRow> rows(10);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    rows[n].state = "done";
    rows[n].values["surface.thickness_mean"] = std::to_string(2.5 + 0.01 * static_cast<double>(n));
    rows[n].values["surface.euler_characteristic"] = n == 3 ? "0" : "2";
  }
  rows[7].values["surface.thickness_mean"] = "4.5";
  rows[9].state = "stopped early (unfold)";
  const auto flags = flagsOf(rows);
  for (std::size_t n = 0; n < rows.size(); ++n) {
    ASSERT_EQ(flags[n].size(), n == 3 || n == 7 || n == 9 ? 1u : 0u) << n;
  }
  EXPECT_EQ(flags[3][0].column, "surface.euler_characteristic");
  // 0.6745 (4.5 - 2.545) / 0.03, the median of the distances from the median.
  EXPECT_EQ(flags[7][0].reason, "robust z 44.0");
  EXPECT_EQ(flags[9][0].column, "state");
  rows.resize(7);  // too few to call one of them far
  rows[6].values["surface.thickness_mean"] = "4.5";
  EXPECT_TRUE(flagsOf(rows)[6].empty());
}

TEST_F(Study, WhatIsCutGuessedOrContradictedIsAColumnAndAFlag) {
  for (const provenance::Doubt& doubt : provenance::kDoubts) {
    const std::string column = std::string("surface.") + doubt.key;
    std::vector<StudyRow> rows(2);
    for (StudyRow& row : rows) row.state = "done";
    rows[0].values[column] = "0";
    rows[1].values[column] = "12";
    const auto flags = flagsOf(rows);
    EXPECT_TRUE(flags[0].empty()) << column;
    ASSERT_EQ(flags[1].size(), 1u) << column;
    EXPECT_EQ(flags[1][0].column, column);
    EXPECT_EQ(flags[1][0].reason, doubt.meaning);
    EXPECT_NE(internalsText(rows).find("\t" + column + "\n"), std::string::npos);
    EXPECT_NE(internalsText(rows).find("\t12\n"), std::string::npos);
    EXPECT_NE(tableText(rows).find(column + ": " + doubt.meaning), std::string::npos);
  }
}

TEST_F(Study, PageEscapesAndMarks) {
  StudyRow row;
  row.participant = "sub-</script>";
  row.hemisphere = "L";
  row.state = "failed: a & b";
  row.report = "runs/a/report.html";
  const std::string page = indexPage({row}, "T<i>");
  EXPECT_NE(page.find("T&lt;i&gt;"), std::string::npos);
  EXPECT_NE(page.find("sub-\\u003c/script>"), std::string::npos);
  EXPECT_NE(page.find(R"("flags":{"2":"failed"})"), std::string::npos);
  EXPECT_NE(page.find(R"("report":"runs/a/report.html")"), std::string::npos);
  EXPECT_NE(page.find("0 of 1 hemispheres are done; 1 need a look"), std::string::npos);
}

}  // namespace
}  // namespace explica::study
