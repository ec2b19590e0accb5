// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Study/HeartStudy.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

namespace explica::study {

namespace {

namespace fs = std::filesystem;

/// A folder of the test's own, gone at its end.
class Folder {
 public:
  Folder()
      : path_(fs::temp_directory_path() /
              ("explica-hearts-" + std::to_string(getpid()) + '-' +
               ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] const fs::path& path() const { return path_; }
  void write(const std::string& name, const std::string& text) const {
    fs::create_directories((path_ / name).parent_path());
    writeTextFile(path_ / name, text);
  }

 private:
  fs::path path_;
};

std::vector<std::string> namesOf(const std::vector<HeartSubject>& subjects) {
  std::vector<std::string> names;
  for (const HeartSubject& subject : subjects) names.push_back(subject.name);
  return names;
}

}  // namespace

TEST(HeartStudy, FindsPeopleSessionsAndFramesByTheEndingsOfNames) {
  const Folder folder;
  for (const char* file :
       {"sub-02/ses-b/anat/sub-02_ses-b_frame-ES_dseg.nii.gz",
        "sub-02/ses-b/anat/sub-02_ses-b_frame-ED_dseg.nii.gz",
        "sub-02/ses-b/anat/sub-02_ses-b_cine.nii.gz", "sub-02/ses-a/sub-02_ses-a_dseg.nii",
        "sub-01/cmr/sub-01_label.nii.gz", "patient007/patient007_frame01_gt.nii.gz",
        "patient007/patient007_frame11_gt.nii.gz", "patient007/patient007_frame01.nii.gz",
        "sub-03/readme.txt", "notes/readme.txt", "derivatives/sub-09/sub-09_dseg.nii.gz"}) {
    folder.write(file, "");
  }
  const auto found = findHearts(folder.path());
  EXPECT_EQ(namesOf(found), (std::vector<std::string>{"patient007", "sub-01", "sub-02_ses-a",
                                                      "sub-02_ses-b", "sub-03"}));
  EXPECT_EQ(found[0].labels.size(), 2U);
  EXPECT_EQ(found[0].labels[1].filename(), "patient007_frame11_gt.nii.gz");
  ASSERT_EQ(found[3].labels.size(), 2U);
  EXPECT_EQ(found[3].labels[0].filename(), "sub-02_ses-b_frame-ED_dseg.nii.gz");
  EXPECT_EQ(found[3].folder, "sub-02/ses-b");
  EXPECT_TRUE(found[4].labels.empty());
  EXPECT_EQ(namesOf(findHearts(folder.path(), {"02", "patient007"})),
            (std::vector<std::string>{"patient007", "sub-02_ses-a", "sub-02_ses-b"}));
  EXPECT_EQ(findHearts(folder.path(), {"02"}, {{"_cine"}})[1].labels.size(), 1U);
  EXPECT_THROW((void)findHearts(folder.path(), {"04"}), InvalidInput);
  EXPECT_THROW((void)findHearts(folder.path() / "notes"), InvalidInput);
  EXPECT_THROW((void)findHearts(folder.path() / "absent"), InvalidInput);
}

TEST(HeartStudy, TableHoldsOneRowAPersonWhateverBecameOfIt) {
  const Folder folder;
  folder.write("participants.tsv", "age\tparticipant_id\r\n40\tsub-1\r\n52\tsub-2\r\n");
  folder.write("sub-1/heart/summary.json",
               R"({"cavity_volume_ed_ml": 120.5, "frame_ed": 0, "frame_es": 9,
                         "orientation": "<b>", "mass_ed_g": null})");
  folder.write("sub-1/heart/segments.tsv",
               "segment\tname\tframe\tthickness\tthickening\n1\tbasal\t0\t6.1\t0\n"
               "1\tbasal\t9\t9.0\t47.5\n17\tapex\t0\tn/a\t0\n1\tbasal\t4\t7.0\t10\n");
  folder.write("sub-2/heart/problem.txt", "no\twall\n");
  const auto about = aboutParticipants(folder.path());
  const auto rows = heartRows(
      folder.path(), {{"sub-1", "sub-1", {}}, {"sub-2", "sub-2", {}}, {"x", "x", {}}}, about);
  const std::string table = heartTable(rows);
  EXPECT_EQ(table.find("participant_id\tage\tstate\tcavity_volume_ed_ml\t"), 0U) << table;
  EXPECT_NE(table.find("\nsub-1\t40\tdone\t120.5\tn/a\t"), std::string::npos) << table;
  EXPECT_NE(table.find("\nsub-2\t52\tfailed: no wall\tn/a\t"), std::string::npos) << table;
  EXPECT_NE(table.find("\nx\tn/a\tnot begun\tn/a\t"), std::string::npos) << table;
  EXPECT_NE(table.find("segment_01_thickening\tsegment_01_thickness_ed\tsegment_01_thickness_es\t"
                       "segment_17_thickness_ed\n"),
            std::string::npos)
      << table;
  EXPECT_NE(table.find("\t47.5\t6.1\t9.0\tn/a\n"), std::string::npos) << table;
  const std::string columns = heartColumns(rows);
  EXPECT_NE(columns.find("segment_01_thickening"), std::string::npos);
  EXPECT_NE(columns.find("\"Units\": \"mL\""), std::string::npos);
  const std::string page = heartPage(rows, "A & B");
  EXPECT_NE(page.find("<h1>A &amp; B</h1>"), std::string::npos);
  EXPECT_NE(page.find("<td class=\"n\">120.5</td>"), std::string::npos);
  EXPECT_NE(page.find("1 of 3 hearts"), std::string::npos);
  EXPECT_EQ(page.find("http"), std::string::npos);
  EXPECT_NE(page.find("prefers-color-scheme:dark"), std::string::npos);
  EXPECT_NE(page.find("<main>"), std::string::npos) << "a landmark for screen readers";
  EXPECT_EQ(page.find("bullseye.png"), std::string::npos) << "letters of pixels";
}

TEST(HeartStudy, ParticipantsNeedTheirIdentifier) {
  const Folder folder;
  EXPECT_TRUE(aboutParticipants(folder.path()).empty());
  folder.write("participants.tsv", "name\tage\nsub-1\t40\n");
  EXPECT_THROW((void)aboutParticipants(folder.path()), InvalidInput);
}

}  // namespace explica::study
