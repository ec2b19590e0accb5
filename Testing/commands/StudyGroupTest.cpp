// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// From people to a group: phantoms of known thickness on a template made of one of them.

#include "Explica/IO/VertexDataFile.h"
#include "QuickRuns.h"
#include "SmallStudy.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

constexpr std::array kThickness = {"2.4", "2.6", "2.8", "3.0", "3.2"};  // mm; the last is doubted
constexpr const char* kMap = "_space-made_den-642_thickness.shape.gii";

/// Five phantoms taken through `bids`, once for all tests; a sixth person fails.
class StudyGroup : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const SmallStudy study(folder_->path(), {"1", "2", "3", "4", "5"});
    for (std::size_t n = 0; n < kThickness.size(); ++n) {
      const std::string phantom = *folder_ / ("phantom" + std::to_string(n));
      ASSERT_EQ(explica({"phantom", "cortex", "--size", "32", "--spacing", "2", "--thickness",
                         kThickness[n], "--out", phantom})
                    .exitCode,
                0);
      fs::copy_file(phantom + "/labels.nii.gz", study.labels(std::to_string(n + 1)),
                    fs::copy_options::overwrite_existing);
    }
    fs::create_directories(*folder_ / "data/sub-6/anat");
    writeText(*folder_ / "data/participants.tsv",
              "participant_id\tage\nsub-1\t20\nsub-2\t31\nsub-3\t42\nsub-4\t50\nsub-5\t61\n");
    makeTemplate(study.labels("1"));
    made_ = new CommandResult(participants(study.out()));
    doubt("sub-5");
  }
  static void TearDownTestSuite() {
    delete made_;
    delete folder_;
  }

  /// A template is what `surface` leaves, with its sphere.
  static void makeTemplate(const fs::path& labels) {
    const std::string place = *folder_ / "made";
    ASSERT_EQ(explica({"surface", labels.string(), "--atlas", labels.string(), "--faces", "1000",
                       "--hemisphere", "L", "--out", place})
                  .exitCode,
              0);
    ASSERT_EQ(explica({"sphere", place + "/white.surf.gii", "--out", *folder_ / "ball"}).exitCode,
              0);
    fs::copy_file(*folder_ / "ball/sphere.surf.gii", place + "/sphere.surf.gii");
  }

  static fs::path run(const std::string& person) {
    return fs::path(*folder_ / "out/runs") / (person + "_hemi-L");
  }

  static CommandResult participants(const std::string& out, std::vector<std::string> more = {}) {
    return explica(std::vector<std::string>{"bids", *folder_ / "data", out, "participant",
                                            "--hemisphere", "L", "--steps",
                                            "surface,sphere,register,parcellate", "--surface.faces",
                                            "1000", "--register.level", "3", "--template",
                                            *folder_ / "made", "--resample.to", "fsaverage3"} +
                   more);
  }

  static void doubt(const std::string& person) {
    auto summary = readJson(run(person) / "surface/summary.json");
    summary["verdict"] = "doubtful";
    summary["reasons"] = {"much of its cortex is missing"};
    writeText(run(person) / "surface/summary.json", summary.dump());
  }

  static CommandResult group(std::vector<std::string> more = {}) {
    return explica(std::vector<std::string>{"bids", *folder_ / "data", *folder_ / "out", "group"} +
                   more);
  }

  static std::vector<io::VertexMap> maps(const fs::path& file) { return io::readVertexMaps(file); }
  static Eigen::VectorXd thicknessOf(const std::string& person) {
    return maps(run(person) / "resample/thickness_space-made_den-642.shape.gii")[0].values;
  }

  static inline TemporaryFolder* folder_ = nullptr;
  static inline CommandResult* made_ = nullptr;
};

TEST_F(StudyGroup, EveryPersonIsBroughtToTheTemplate) {
  EXPECT_EQ(made_->exitCode, 3) << *made_;  // one has nothing to start from
  for (const char* person : {"sub-1", "sub-5"}) {
    for (const char* file :
         {"sphere/lh.sphere", "register/lh.sphere.reg", "parcellate/regions.label.gii",
          "regions/regions.tsv", "resample/area_space-made_den-642.shape.gii"}) {
      EXPECT_TRUE(fs::exists(run(person) / file)) << person << " " << file;
    }
  }
  // The areas of a vertex are handed on whole.
  const double before = maps(run("sub-2") / "surface/area.shape.gii")[0].values.sum();
  const auto there = maps(run("sub-2") / "resample/area_space-made_den-642.shape.gii");
  EXPECT_NEAR(there[0].values.sum() / before, 1, 1e-5);
}

TEST_F(StudyGroup, WhoIsDoubtedOrFailedIsLeftOutAndNamed) {
  const CommandResult made = group();
  ASSERT_EQ(made.exitCode, 0) << made;
  EXPECT_NE(made.err.find("left out of the group: sub-5_hemi-L: implausible (surface): much of"),
            std::string::npos)
      << made;
  const fs::path out = *folder_ / "out";
  const std::string people = readText(out / "group/people.tsv");
  EXPECT_NE(people.find("sub-1\tL\tyes\tn/a\t"), std::string::npos) << people;
  EXPECT_NE(people.find("sub-5\tL\tno\timplausible (surface): much of its cortex is missing\t"),
            std::string::npos)
      << people;
  EXPECT_NE(people.find("sub-6\tL\tno\tfailed: "), std::string::npos) << people;
  EXPECT_NE(people.find("\t42\n"), std::string::npos) << people;  // age
  const auto group = maps(out / ("group/hemi-L" + std::string(kMap)));
  const Eigen::VectorXd mean =
      (thicknessOf("sub-1") + thicknessOf("sub-2") + thicknessOf("sub-3") + thicknessOf("sub-4")) /
      4;
  EXPECT_LT((group[0].values - mean).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_EQ(group[3].values.minCoeff(), 4);
  const std::string regions = readText(out / "group/regions.tsv");
  EXPECT_NE(regions.find("\tthickness_mean\t"), std::string::npos);
  EXPECT_NE(regions.find("\tno\t61\n"), std::string::npos);
  const std::string table = readText(out / "study.tsv");
  EXPECT_NE(table.find("participant.age"), std::string::npos);
  EXPECT_NE(table.find("implausible (surface)"), std::string::npos);
  EXPECT_NE(readText(out / "index.html").find("Together on the template"), std::string::npos);
  const auto summary = readJson(out / "summary.json");
  EXPECT_EQ(summary["hemispheres_in_group"], 4);
  EXPECT_EQ(summary["hemispheres_left_out"], 2);
}

TEST_F(StudyGroup, WhoIsDoubtedIsTakenInByName) {
  const CommandResult made = group({"--include", "5"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto all = maps(*folder_ / ("out/group/hemi-L" + std::string(kMap)));
  EXPECT_EQ(all[3].values.minCoeff(), 5);
  const std::string people = readText(*folder_ / "out/group/people.tsv");
  EXPECT_NE(people.find("sub-5\tL\tyes\tincluded: implausible"), std::string::npos) << people;
  const CommandResult unknown = group({"--include", "sub-77"});
  EXPECT_EQ(unknown.exitCode, 2);
  EXPECT_NE(unknown.err.find("there is no sub-77"), std::string::npos) << unknown;
}

TEST_F(StudyGroup, OfWhatIsKeptForItComesTheSame) {
  const std::string all = *folder_ / "all", few = *folder_ / "few";
  const std::vector<std::string> two = {"--participant-label", "1", "2", "3"};
  ASSERT_EQ(participants(all, two).exitCode, 0);
  const CommandResult kept = participants(few, two + std::vector<std::string>{"--keep", "group"});
  ASSERT_EQ(kept.exitCode, 0) << kept;
  for (const char* person : {"sub-1", "sub-2", "sub-3"}) {
    const fs::path run = fs::path(few) / "runs" / (std::string(person) + "_hemi-L");
    int files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(run))
      files += entry.is_regular_file();
    EXPECT_LE(files, 4) << person << ": a hemisphere";
    EXPECT_FALSE(fs::exists(fs::path(few) / (std::string(person) + ".html")));
    EXPECT_TRUE(fs::exists(run / "maps_space-made_den-642.shape.gii")) << person;
    EXPECT_FALSE(fs::exists(run / "surface")) << person;
  }
  // What is kept is enough for the tables, the group's maps and a model of them.
  for (const std::string& out : {all, few}) {
    const CommandResult made =
        explica({"bids", *folder_ / "data", out, "group", "--model", "thickness ~ age"});
    ASSERT_EQ(made.exitCode, 0) << made;
  }
  int compared = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(all) / "group")) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".tsv") && !name.ends_with(".gii")) continue;
    const fs::path other = fs::path(few) / fs::relative(entry.path(), all);
    EXPECT_EQ(readText(entry.path()), readText(other)) << other;
    ++compared;
  }
  EXPECT_GT(compared, 5);
  // Done again, nothing is: what was kept is of the same inputs and options.
  const fs::path map = fs::path(few) / "runs/sub-1_hemi-L/maps_space-made_den-642.shape.gii";
  const auto before = fs::last_write_time(map);
  ASSERT_EQ(participants(few, two + std::vector<std::string>{"--keep", "group"}).exitCode, 0);
  EXPECT_EQ(fs::last_write_time(map), before);
}

TEST_F(StudyGroup, AModelIsFittedToWhoIsIn) {
  const CommandResult made = group({"--include", "5", "--model", "thickness ~ age"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto effect = maps(*folder_ / "out/group/glm/age_effect.shape.gii");
  // 0.2 mm in 10 years.
  EXPECT_NEAR(effect[0].values.mean(), 0.02, 0.008);
  EXPECT_EQ(readJson(*folder_ / "out/group/glm/summary.json")["people"], 5);
}

TEST_F(StudyGroup, ABadModelNamesItsColumn) {
  const CommandResult made = group({"--model", "thickness ~ weight"});
  EXPECT_EQ(made.exitCode, 2) << made;
  EXPECT_NE(made.err.find("weight"), std::string::npos) << made;
}

TEST_F(StudyGroup, OfTwoTemplatesThePersonIsNamed) {
  const fs::path place = run("sub-3") / "resample";
  const fs::path file = place / "thickness_space-made_den-642.shape.gii";
  fs::rename(file, place / "thickness_space-other_den-642.shape.gii");
  const CommandResult made = group();
  fs::rename(place / "thickness_space-other_den-642.shape.gii", file);
  EXPECT_EQ(made.exitCode, 2);
  EXPECT_NE(made.err.find("sub-3_hemi-L is on space-other_den-642"), std::string::npos) << made;
}

}  // namespace
}  // namespace explica::testing
