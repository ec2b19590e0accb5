// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Core/WholeFile.h"
#include "Explica/Study/StudyState.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <Eigen/Core>

namespace explica::study {
namespace {

namespace fs = std::filesystem;
using provenance::Json;

const PathOptions kPaths = {"surface.fs-volume"};

Json smallSchema() {
  const Json number = {{"type", "number"}};
  const Json point = {{"type", "array"}, {"minItems", 3}, {"maxItems", 3}, {"items", number}};
  const Json whole = {{"type", "integer"}};
  return studySchema({{"surface.faces", whole},
                      {"surface.fs-volume", {{"type", "string"}}},
                      {"unfold.radius", number},
                      {"unfold.vertex", whole},
                      {"unfold.center", point},
                      {"unfold.viewpoint", point},
                      {"unfold.direction", point},
                      {"steps", {{"type", "array"}, {"items", {{"enum", {"surface", "unfold"}}}}}}},
                     {{"radius", number},
                      {"vertex", whole},
                      {"center", point},
                      {"viewpoint", point},
                      {"direction", point}});
}

class StudyFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("explica-study-file-" + std::to_string(getpid()));
    fs::create_directories(folder_);
    writeTextFile(folder_ / "labels.nii", "labels");
  }
  void TearDown() override { fs::remove_all(folder_); }

  StudyFile read(const std::string& text, const std::string& name = "study.yaml") const {
    writeTextFile(folder_ / name, text);
    StudyFile file = readStudyFile(folder_ / name);
    checkStudyFile(file, smallSchema());
    return file;
  }
  Study plan(const std::string& text) const { return planStudy(read(text), kPaths); }

  /// The sentence that refuses a text, without the file's folder; empty if it is taken.
  std::string refusal(const std::string& text) const {
    try {
      plan(text);
      return "";
    } catch (const Error& fault) {
      const std::string said = fault.what();
      const std::string folder = folder_.string() + "/";
      EXPECT_EQ(said.rfind(folder, 0), 0u) << said;
      return said.substr(folder.size());
    }
  }

  fs::path folder_;
};

TEST_F(StudyFiles, YamlAndJsonSayTheSame) {
  const Json yaml =
      read("subjects: [01, 10]\ninput: a\nparameters: {unfold: {radius: 1.5}}").values;
  const Json json = read(R"({"subjects": ["01", 10], "input": "a",
                            "parameters": {"unfold": {"radius": 1.5}}})",
                         "study.json")
                        .values;
  EXPECT_EQ(yaml, json);
}

TEST_F(StudyFiles, AFaultIsToldInOneSentenceWithLinePlaceAndRemedy) {
  const std::pair<const char*, const char*> cases[] = {
      {"subjects: [01]\nparameters:\n  surface: {face: 3}",
       "study.yaml, line 3, parameters.surface.face: unknown key; did you mean 'faces'?"},
      {"subjects: [01]\nparameters: {surface.faces: many}",
       "study.yaml, line 2, parameters.surface.faces: \"many\" is not a whole number"},
      {"subjects: [01]\nparameters: {steps: [unfolt]}",
       "study.yaml, line 2, parameters.steps.0: \"unfolt\" is not one of surface, unfold"},
      {"subjects:\n  01: {}\n  02: {parameters: {unfold: {center: [1, 2]}}}",
       "study.yaml, line 3, subjects.02.parameters.unfold.center: has 2 elements; 3 are needed"},
      {"subjects: [a b]",
       "study.yaml, line 1, subjects.0: \"a b\": a label may hold only letters and digits, then "
       "_ses- and the same"},
      {"subjects: [01]\nname: a\nname: b",
       "study.yaml, line 3: 'name' is given twice, first in line 2; remove one"},
      {"subjects: [01",
       "study.yaml, line 1: is not YAML (end of sequence flow not found); mend "
       "the line or the one before"},
      {"name: a", "study.yaml: names no subjects; add subjects, or a dataset to take all of it"},
      {"subjects: [01]",
       "study.yaml, line 1, subjects.01: has no input; give it one, or the study an input with "
       "{subject} in it or a dataset"},
      {"input: a\nsubjects: [01, 02, sub-01]",
       "study.yaml, line 2, subjects.2: subject 01 is given twice; remove one"},
      {"input: a\nsubjects: [01]\nregions: {a: {space: common, center: [1, 2, 3]}}",
       "study.yaml, line 3, regions.a: is in common coordinates, but subject 01 has no to-common; "
       "give it the matrix from its own coordinates"},
      {"input: a\nsubjects: {01: {regions: {b: {radius: 2}}}}\nregions: {a: {radius: 3}}",
       "study.yaml, line 2, subjects.01.regions.b: the study has no region of this name; add it "
       "to regions"},
      {"a: &x [*x]", "study.yaml, line 1: is nested too deeply; an alias (*name) may hold itself"},
  };
  for (const auto& [text, expected] : cases) EXPECT_EQ(refusal(text), expected);
}

TEST_F(StudyFiles, EveryHemisphereAndRegionIsARun) {
  const Study study = plan(
      "subjects: [01_ses-a]\ninput: labels.nii\n"
      "regions: {hand: {radius: 2}, foot: {radius: 3, hemispheres: [R]}}");
  std::vector<std::string> folders;
  for (const auto& run : study.subjects.at(0).runs) folders.push_back(run.folder);
  EXPECT_EQ(folders, (std::vector<std::string>{"sub-01_ses-a_hemi-L_region-hand",
                                               "sub-01_ses-a_hemi-R_region-hand",
                                               "sub-01_ses-a_hemi-R_region-foot"}));
  EXPECT_EQ(study.subjects[0].participant.input, folder_ / "labels.nii");
  EXPECT_EQ(study.subjects[0].participant.problem, "");
}

TEST_F(StudyFiles, WhatASubjectSaysWins) {
  const Study study = plan(
      "input: no-{subject}\nhemispheres: [L]\n"
      "parameters: {surface: {faces: 5, fs-volume: 'x/{subject}'}, unfold.vertex: 4}\n"
      "subjects:\n  01:\n  02: {input: labels.nii, parameters: {surface.faces: 6, unfold: {center: "
      "[1, 2, 3]}}}");
  const PlannedSubject &first = study.subjects.at(0), &second = study.subjects.at(1);
  EXPECT_NE(first.participant.problem.find("no-01 does not exist"), std::string::npos);
  EXPECT_EQ(first.runs.at(0).values["surface.faces"], 5);
  EXPECT_EQ(first.runs.at(0).values["surface.fs-volume"], (folder_ / "x/01").string());
  EXPECT_EQ(second.participant.problem, "");
  EXPECT_EQ(second.runs.at(0).values["surface.faces"], 6);
  // A centre by point replaces one by vertex.
  EXPECT_FALSE(second.runs.at(0).values.contains("unfold.vertex"));
}

TEST_F(StudyFiles, CommonCoordinatesGoThroughTheInverseOfEachSubjectsMatrix) {
  // c = A s: x' = 2 y + 1, y' = -x, z' = z.  Subject 02 has the same matrix in a file.
  writeTextFile(folder_ / "matrix.txt", "0 2 0 1\n-1 0 0 0\n0 0 1 0\n0 0 0 1\n");
  const Study study = plan(
      "input: labels.nii\nhemispheres: [L]\n"
      "regions: {a: {space: common, center: [5, -3, 7], direction: [0, -2, 0], radius: 4},\n"
      "          b: {space: common, viewpoint: [1, 0, 100]}}\n"
      "subjects:\n"
      "  01: {to-common: [[0, 2, 0, 1], [-1, 0, 0, 0], [0, 0, 1, 0]]}\n"
      "  02: {to-common: matrix.txt, regions: {a: {viewpoint: [9, 9, 9]}}}\n");
  const auto near = [](const Json& value, const Eigen::Vector3d& expected) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(value.at(i).get<double>(), expected[i], 1e-12);
  };
  ASSERT_EQ(study.subjects.size(), 2u);
  const auto& runs = study.subjects[0].runs;
  near(runs.at(0).values["unfold.center"], {3, 2, 7});
  near(runs.at(0).values["unfold.direction"], {1, 0, 0});
  EXPECT_EQ(runs.at(0).values["unfold.radius"], 4);
  near(runs.at(1).values["unfold.viewpoint"], {0, 0, 100});
  // The subject's own viewpoint stands in its own coordinates, in place of the direction.
  const Json& own = study.subjects[1].runs.at(0).values;
  near(own["unfold.center"], {3, 2, 7});
  near(own["unfold.viewpoint"], {9, 9, 9});
  EXPECT_FALSE(own.contains("unfold.direction"));
}

TEST_F(StudyFiles, AMatrixThatCannotBeOneIsRefused) {
  const std::string begin =
      "input: a\nregions: {a: {space: common, center: [1, 2, 3]}}\nsubjects: {01: {to-common: ";
  EXPECT_NE(
      refusal(begin + "[[1, 0, 0, 0], [0, 1, 0, 0], [1, 1, 0, 0]]}}").find("is not an affine"),
      std::string::npos);
  EXPECT_NE(refusal(begin + "absent.txt}}").find("absent.txt: cannot be read"), std::string::npos);
  writeTextFile(folder_ / "words.txt", "1 0 0 0\n0 1 0 nought\n0 0 1 0\n");
  EXPECT_NE(refusal(begin + "words.txt}}").find("does not hold 3 or 4 rows"), std::string::npos);
}

TEST_F(StudyFiles, TheKeyFollowsContentAndOptionsNotPathsDatesOrOrder) {
  const auto key = [&](const std::string& text) {
    return keyOf(plan(text).subjects.at(0), kPaths);
  };
  const std::string first =
      key("input: labels.nii\nsubjects: [01]\nparameters: {surface.faces: 5, unfold.radius: 2}");
  EXPECT_EQ(first.size(), 16u);
  writeTextFile(folder_ / "elsewhere.nii", "labels");
  fs::last_write_time(folder_ / "elsewhere.nii", fs::file_time_type::clock::now());
  EXPECT_EQ(key("parameters: {unfold: {radius: 2}, surface: {faces: 5}}\nsubjects: {01: {input: "
                "elsewhere.nii}, 02: {input: labels.nii}}"),
            first);
  EXPECT_NE(key("input: labels.nii\nsubjects: [01]\nparameters: {surface.faces: 6}"), first);
  writeTextFile(folder_ / "labels.nii", "Labels");
  EXPECT_NE(key("input: labels.nii\nsubjects: [01]\nparameters: {surface.faces: 5, unfold.radius: "
                "2}"),
            first);
}

TEST_F(StudyFiles, ASubjectIsSettledForOneKey) {
  const Study study = plan("input: labels.nii\nsubjects: [01, 011]\n");
  const fs::path out = folder_ / "out";
  const PlannedSubject &one = study.subjects.at(0), &other = study.subjects.at(1);
  settle(out, one, "0123456789abcdef");
  settle(out, other, "0123456789abcdef");
  EXPECT_TRUE(fs::exists(out / "state" / "sub-01-0123456789abcdef.json"));
  unsettle(out, one);
  EXPECT_FALSE(fs::exists(stateFile(out, one, "0123456789abcdef")));
  EXPECT_TRUE(fs::exists(stateFile(out, other, "0123456789abcdef")));
}

}  // namespace
}  // namespace explica::study
