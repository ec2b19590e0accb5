// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Whole runs, on a small phantom.

#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VolumeFile.h"
#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

/// A run from labels to report that takes seconds.
std::vector<std::string> smallRun(const TemporaryFolder& folder, const std::string& out,
                                  std::vector<std::string> more = {}) {
  std::vector<std::string> words = {"run",
                                    folder / "phantom/labels.nii.gz",
                                    "--out",
                                    folder / out,
                                    "--surface.faces",
                                    "3000",
                                    "--unfold.radius",
                                    "9",
                                    "--unfold.max-iterations",
                                    "2",
                                    "--unfold.frames",
                                    "3"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

void makePhantom(const TemporaryFolder& folder) {
  ASSERT_EQ(explica({"phantom", "cortex", "--size", "40", "--depth", "0.1", "--waves", "3", "--out",
                     folder / "phantom"})
                .exitCode,
            0);
}

std::map<std::string, std::string> statesOf(const fs::path& out) {
  std::map<std::string, std::string> states;
  const auto run = readJson(out / "run.json");
  for (const auto& step : run["steps"]) states[step["name"]] = step["state"];
  return states;
}

TEST(Run, GoesFromLabelsToAReport) {
  TemporaryFolder folder;
  makePhantom(folder);
  const auto run = explica(smallRun(folder, "out"));
  EXPECT_TRUE(run.exitCode == 0 || run.exitCode == 3) << run;
  for (const char* file : {"thickness/thickness.nii.gz", "surface/white.surf.gii",
                           "surface/pial.surf.gii", "unfold/unfolded.surf.gii", "report.html",
                           "thumbnail.png", "summary.json", "provenance.json"}) {
    EXPECT_TRUE(fs::exists(fs::path(folder / "out") / file)) << file;
  }
  for (const char* step : {"thickness", "surface", "unfold"}) {
    EXPECT_TRUE(fs::exists(fs::path(folder / "out") / step / "provenance.json")) << step;
    EXPECT_TRUE(fs::exists(fs::path(folder / "out") / step / "summary.json")) << step;
  }
  EXPECT_EQ(explica({"verify", folder / "out/surface/provenance.json"}).exitCode, 0);
  const std::string page = readText(folder / "out/report.html");
  EXPECT_NE(page.find("class=\"evolution\""), std::string::npos);
  // Each step's command can be pasted into a shell.
  EXPECT_NE(page.find(">explica surface "), std::string::npos);
  EXPECT_EQ(page.find("{&quot;"), std::string::npos);
}

/// Lines of progress: "surface: remeshing: 40 %".
std::vector<std::string> progressIn(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (line.ends_with(" %")) lines.push_back(line);
  }
  return lines;
}

TEST(Run, ProgressIsALineAStepAndNeverFalls) {
  TemporaryFolder folder;
  makePhantom(folder);
  std::map<std::string, int> linesOf;
  for (const std::string& line : progressIn(explica(smallRun(folder, "out")).err)) {
    ++linesOf[line.substr(0, line.find(':'))];
  }
  for (const char* step : {"thickness", "surface", "unfold"}) EXPECT_EQ(linesOf[step], 1) << step;
  // A command on its own says each tenth, each once.
  const auto alone = explica({"thickness", folder / "phantom/labels.nii.gz", "--inner", "3",
                              "--tissue", "2", "--out", folder / "alone"});
  const auto lines = progressIn(alone.err);
  EXPECT_GE(lines.size(), 3U) << alone;
  int last = -1;
  for (const std::string& line : lines) {
    const int percent = std::stoi(line.substr(line.rfind(": ") + 2));
    EXPECT_GT(percent, last) << alone;
    last = percent;
  }
}

TEST(Run, ResumesWhatIsStillTrueAndRedoesWhatIsNot) {
  TemporaryFolder folder;
  makePhantom(folder);
  const std::vector<std::string> steps = {"--steps", "thickness,surface"};
  ASSERT_EQ(explica(smallRun(folder, "out", steps)).exitCode, 0);
  const auto before = stableHashes(folder / "out/surface");
  std::vector<std::string> again = steps;
  again.emplace_back("--resume");
  auto run = explica(smallRun(folder, "out", again));
  EXPECT_EQ(run.exitCode, 0) << run;
  EXPECT_NE(run.err.find("thickness: kept"), std::string::npos) << run;
  EXPECT_NE(run.err.find("surface: kept"), std::string::npos) << run;

  writeText(folder / "out/surface/white.surf.gii", "damaged");
  run = explica(smallRun(folder, "out", again));
  EXPECT_EQ(run.exitCode, 0) << run;
  EXPECT_NE(run.err.find("thickness: kept"), std::string::npos) << run;
  EXPECT_EQ(run.err.find("surface: kept"), std::string::npos) << run;
  EXPECT_EQ(stableHashes(folder / "out/surface"), before);

  again.insert(again.end(), {"--thickness.lambda", "0.7"});
  run = explica(smallRun(folder, "out", again));
  EXPECT_EQ(run.err.find("thickness: kept"), std::string::npos) << run;
  EXPECT_NE(run.err.find("surface: kept"), std::string::npos) << run;
}

TEST(Run, AFailedRunLeavesNothing) {
  TemporaryFolder folder;
  makePhantom(folder);
  fs::create_directories(folder / "there");
  const auto before = folder.entries();
  for (const char* out : {"fresh", "there"}) {
    const auto run =
        explica(smallRun(folder, out, {"--unfold.vertex", "99999999", "--force", "--quiet"}));
    EXPECT_EQ(run.exitCode, 2) << run;
    EXPECT_EQ(folder.entries(), before);
  }
}

TEST(Run, AFailedStepOfARunToResumeIsNamedAndTheOthersStay) {
  TemporaryFolder folder;
  makePhantom(folder);
  const auto run = explica(smallRun(folder, "out", {"--resume", "--unfold.vertex", "99999999"}));
  EXPECT_EQ(run.exitCode, 2) << run;
  const auto states = statesOf(folder / "out");
  EXPECT_EQ(states.at("surface"), "done");
  EXPECT_EQ(states.at("unfold"), "failed");
  EXPECT_TRUE(fs::exists(folder / "out/surface/pial.surf.gii"));
  const std::string page = readText(folder / "out/report.html");
  EXPECT_NE(page.find("badge bad'>failed"), std::string::npos);
}

/// Numbers of a run's surface step.
nlohmann::ordered_json surfaceOf(const fs::path& out) {
  return readJson(out / "surface/summary.json");
}

TEST(Run, SurfacesOfAFreeSurferSubjectAreTakenOver) {
  TemporaryFolder folder;
  makePhantom(folder);
  ASSERT_EQ(explica({"surface", folder / "phantom/labels.nii.gz", "--faces", "3000", "--out",
                     folder / "made", "--freesurfer", folder / "subject/surf"})
                .exitCode,
            0);
  ASSERT_TRUE(fs::exists(folder / "subject/surf/lh.pial"));
  const auto run = explica(
      {"run", folder / "subject", "--out", folder / "out", "--steps", "thickness,surface,report"});
  ASSERT_EQ(run.exitCode, 0) << run;
  EXPECT_NE(run.err.find("white surface: " + (folder / "subject/surf/lh.white")), std::string::npos)
      << run;
  EXPECT_NE(run.err.find("there are no labels"), std::string::npos) << run;
  const auto taken = surfaceOf(folder / "out");
  const auto made = readJson(folder / "made/summary.json");
  EXPECT_EQ(taken["surfaces"], "given");
  EXPECT_EQ(taken["vertices"], made["vertices"]);
  EXPECT_EQ(taken["euler_characteristic"], 2);
  EXPECT_NEAR(taken["area_white"].get<double>(), made["area_white"].get<double>(), 1e-2);
  // The shortest way both ways is shorter than a trajectory, but not by much.
  const double distance = taken["thickness_mean"], length = made["thickness_mean"];
  EXPECT_LT(distance, length);
  EXPECT_GT(distance, 0.8 * length);
  EXPECT_FALSE(fs::exists(folder / "out/thickness"));

  const auto right = explica(
      {"run", folder / "subject", "--hemisphere", "R", "--out", folder / "right", "--quiet"});
  EXPECT_EQ(right.exitCode, 2) << right;
  EXPECT_FALSE(fs::exists(folder / "right"));
}

TEST(Run, ClassesInTheOrderOfBidsAreTold) {
  TemporaryFolder folder;
  makePhantom(folder);
  auto labels = io::readLabels(folder / "phantom/labels.nii.gz").volume;
  for (Label& label : labels.data) label = label == 0 ? 0 : (label + 1) % 3 + 1;  // 2 3 1 -> 1 2 3
  const fs::path anat = folder / "sub-01/anat";
  fs::create_directories(anat);
  io::writeVolume(anat / "sub-01_dseg.nii.gz", labels);
  const std::vector<std::string> steps = {"--steps", "thickness,surface", "--surface.faces",
                                          "3000"};
  const auto bids =
      explica(std::vector<std::string>{"run", folder / "sub-01", "--out", folder / "bids"} + steps);
  ASSERT_EQ(bids.exitCode, 0) << bids;
  EXPECT_NE(bids.err.find("(1 grey, 2 white, 3 fluid)"), std::string::npos) << bids;
  const auto ours = explica(
      std::vector<std::string>{"run", folder / "phantom/labels.nii.gz", "--out", folder / "ours"} +
      steps);
  ASSERT_EQ(ours.exitCode, 0) << ours;
  for (const char* file : {"thickness/thickness.nii.gz", "surface/pial.surf.gii"}) {
    EXPECT_EQ(readText(folder / "bids" + ("/" + std::string(file))),
              readText(folder / "ours" + ("/" + std::string(file))))
        << file;
  }
}

TEST(Run, FreeSurfersSampleSubjectHasItsRegionsThickness) {
  const fs::path bert = fs::path(EXPLICA_REAL_DATA) / "bert_freesurfer";
  if (!fs::exists(bert)) GTEST_SKIP() << "skipped: no real data";
  TemporaryFolder folder;
  const auto run = explica({"run", bert.string(), "--hemisphere", "R", "--steps", "surface",
                            "--surface.faces", "20000", "--out", folder / "out"});
  ASSERT_EQ(run.exitCode, 0) << run;
  EXPECT_NE(run.err.find("ribbon.mgz (FreeSurfer's ribbon)"), std::string::npos) << run;
  EXPECT_EQ(surfaceOf(folder / "out")["euler_characteristic"], 2);

  std::map<std::string, double> theirs;  // ThickAvg of rh.aparc.stats
  std::ifstream stats(bert / "stats/rh.aparc.stats");
  for (std::string line; std::getline(stats, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string name, vertices, area, volume;
    words >> name >> vertices >> area >> volume >> theirs[name];
  }
  ASSERT_EQ(theirs.size(), 34u);
  std::ifstream table(folder / "out/surface/regions.tsv");
  std::string line;
  std::getline(table, line);
  int regions = 0;
  double sum = 0, sumX = 0, sumY = 0, sumXX = 0, sumYY = 0, sumXY = 0;
  while (std::getline(table, line)) {
    std::istringstream words(line);
    std::string index, name, vertices, area;
    double mean = 0;
    words >> index >> name >> vertices >> area >> mean;
    ASSERT_TRUE(theirs.count(name)) << name;
    const double x = theirs[name];
    sum += mean - x;
    sumX += x, sumY += mean, sumXX += x * x, sumYY += mean * mean, sumXY += x * mean;
    ++regions;
  }
  ASSERT_EQ(regions, 34);
  const double n = regions;
  const double correlation =
      (n * sumXY - sumX * sumY) / std::sqrt((n * sumXX - sumX * sumX) * (n * sumYY - sumY * sumY));
  EXPECT_GT(correlation, 0.95);
  EXPECT_LT(std::abs(sum / n), 0.25);  // a trajectory is longer than the shortest way
}

/// Vertices at which two surfaces have the same place: FreeSurfer's medial wall.
Eigen::Index commonVertices(const fs::path& a, const fs::path& b) {
  const auto first = io::readSurface(a).mesh.positions, second = io::readSurface(b).mesh.positions;
  return ((first - second).rowwise().norm().array() == 0).count();
}

TEST(Run, SurfacesOfTheAverageSubjectKeepTheirMeasures) {
  const fs::path data = fs::path(EXPLICA_REAL_DATA) / "fsaverage5/fs_binary";
  if (!fs::exists(data)) GTEST_SKIP() << "skipped: no real data";
  TemporaryFolder folder;
  fs::create_directories(folder / "subject/surf");
  for (const char* name : {"lh.white", "lh.pial", "rh.white", "rh.pial"}) {
    fs::copy_file(data / name, folder / ("subject/surf/" + std::string(name)));
  }
  const std::map<std::string, double> area = {{"L", 66662}, {"R", 66619}};  // mm^2, SOURCE.md
  for (const char* side : {"L", "R"}) {
    const std::string out = folder / side;
    const auto run = explica(
        {"run", folder / "subject", "--hemisphere", side, "--steps", "surface", "--out", out});
    ASSERT_EQ(run.exitCode, 0) << run;
    const auto summary = surfaceOf(out);
    EXPECT_EQ(summary["vertices"], 10242);
    EXPECT_EQ(summary["structure"], side == std::string("L") ? "CortexLeft" : "CortexRight");
    EXPECT_NEAR(summary["area_white"].get<double>(), area.at(side), 1);
    const std::string prefix = side == std::string("L") ? "lh." : "rh.";
    EXPECT_EQ(summary["vertices_without_grey"],
              commonVertices(data / (prefix + "white"), data / (prefix + "pial")));
  }
}

/// FreeSurfer's ribbon of two balls beside each other.
void writeTwoBalls(const std::string& file) {
  Grid grid;
  grid.size = {64, 36, 36};
  grid.origin = Point(-31.5, -17.5, -17.5);
  Volume<Label> labels(grid, 0);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const Point at = grid.toWorld(Vector(i, j, k));
    const bool left = at.x() < 0;
    const double r = (at - Point(left ? -16 : 16, 0, 0)).norm();
    if (r < 13) labels[v] = r < 10 ? (left ? 2 : 41) : (left ? 3 : 42);
  }
  io::writeVolume(file, labels);
}

TEST(Run, BothHemispheresAreDoneWhereLabelsTellThemApart) {
  TemporaryFolder folder;
  writeTwoBalls(folder / "ribbon.nii.gz");
  const auto run = explica({"run", folder / "ribbon.nii.gz", "--steps", "thickness,surface,report",
                            "--surface.faces", "1500", "--out", folder / "out"});
  EXPECT_EQ(run.exitCode, 0) << run;
  const fs::path out = folder.path() / "out";
  for (const char* side : {"L", "R"}) {
    const auto summary = readJson(out / ("surface-" + std::string(side)) / "summary.json");
    EXPECT_EQ(summary["structure"], *side == 'L' ? "CortexLeft" : "CortexRight");
    EXPECT_NEAR(summary["thickness_mean"].get<double>(), 3, 0.3);
    EXPECT_TRUE(fs::exists(out / ("thickness-" + std::string(side)) / "thickness.nii.gz"));
  }
  EXPECT_NE(readText(out / "report.html").find("right"), std::string::npos);
}

/// Names of the steps in the order in which a record lists them.
std::vector<std::string> stepsIn(const fs::path& out) {
  std::vector<std::string> names;
  const auto record = readJson(out / "provenance.json");
  for (const auto& step : record["execution"]["steps"]) names.push_back(step["name"]);
  return names;
}

TEST(Run, HemispheresSideBySideAreThoseOfOneAfterTheOther) {
  TemporaryFolder folder;
  writeTwoBalls(folder / "ribbon.nii.gz");
  const std::vector<std::string> words = {
      "run",  folder / "ribbon.nii.gz", "--steps", "thickness,surface,unfold", "--surface.faces",
      "1500", "--unfold.radius",        "6",       "--unfold.max-iterations",  "2"};
  const auto one =
      explica(words + std::vector<std::string>{"--threads", "1", "--out", folder / "one"});
  const auto few = explica(words + std::vector<std::string>{"--threads", "1", "--max-memory",
                                                            "4000", "--out", folder / "few"});
  const auto side =
      explica(words + std::vector<std::string>{"--threads", "4", "--out", folder / "side"});
  const std::vector<std::string> steps = {"thickness-L", "surface-L", "unfold-L",
                                          "thickness-R", "surface-R", "unfold-R"};
  std::map<std::string, int> linesOf;
  for (const std::string& line : progressIn(side.err)) ++linesOf[line.substr(0, line.find(':'))];
  for (const std::string& step : steps) {
    EXPECT_EQ(stableHashes(folder.path() / "side" / step),
              stableHashes(folder.path() / "one" / step))
        << step;
    EXPECT_EQ(stableHashes(folder.path() / "few" / step),
              stableHashes(folder.path() / "one" / step))
        << step;
    EXPECT_EQ(linesOf[step], 1) << side;
  }
  for (const char* out : {"one", "few", "side"}) EXPECT_EQ(stepsIn(folder / out), steps) << out;
  const auto first = readJson(folder / "one/summary.json");
  const auto second = readJson(folder / "side/summary.json");
  EXPECT_EQ(first["reasons"], second["reasons"]);
  EXPECT_EQ(first["verdict"], second["verdict"]);
  EXPECT_EQ(first["flags"], second["flags"]);
}

TEST(Run, AFailureOnOneSideEndsTheOtherUnlessTheRunCanBeResumed) {
  TemporaryFolder folder;
  writeTwoBalls(folder / "ribbon.nii.gz");
  const std::vector<std::string> words = {
      "run",  folder / "ribbon.nii.gz", "--steps",  "surface,unfold", "--surface.faces",
      "1500", "--unfold.vertex",        "99999999", "--out",          folder / "out"};
  const auto before = folder.entries();
  const auto failed = explica(words);
  EXPECT_EQ(failed.exitCode, 2) << failed;
  EXPECT_EQ(folder.entries(), before);
  const auto kept = explica(words + std::vector<std::string>{"--resume"});
  EXPECT_EQ(kept.exitCode, 2) << kept;
  const auto states = statesOf(folder / "out");
  for (const std::string side : {"L", "R"}) {
    EXPECT_EQ(states.at("surface-" + side), "done");
    EXPECT_EQ(states.at("unfold-" + side), "failed");
  }
}

TEST(Run, WhatHemispheresShareStaysTillBothAreDone) {
  const fs::path fsaverage = fs::path(EXPLICA_REAL_DATA) / "fsaverage";
  if (!fs::exists(fsaverage)) GTEST_SKIP() << "skipped: no real data";
  TemporaryFolder folder;
  fs::create_directories(folder.path() / "data/sub-1/anat");
  writeText(folder.path() / "data/dataset_description.json",
            R"({"Name": "balls", "BIDSVersion": "1.8.0", "License": "CC0"})");
  writeTwoBalls(folder / "data/sub-1/anat/sub-1_desc-aseg_dseg.nii.gz");
  const auto made =
      explica({"bids", folder / "data", folder / "out", "participant", "--keep", "group", "--steps",
               "surface,sphere,register", "--surface.faces", "1000", "--register.level", "3",
               "--template", fsaverage.string(), "--resample.to", "fsaverage3"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const fs::path runs = folder.path() / "out/runs";
  const fs::path kept = runs / "sub-1_hemi-L/kept.json";
  ASSERT_TRUE(fs::exists(kept)) << made;
  EXPECT_FALSE(fs::exists(runs / "sub-1_hemi-L/surface"));
  // The left run was thinned out after the right one had ended.
  EXPECT_GE(fs::last_write_time(kept), fs::last_write_time(runs / "sub-1_hemi-R/provenance.json"));
}

TEST(Run, ASecondImageWithoutAFirstIsRefused) {
  TemporaryFolder folder;
  makePhantom(folder);
  const auto run = explica(smallRun(folder, "out", {"--t2", folder / "phantom/t1.nii.gz"}));
  EXPECT_EQ(run.exitCode, 1) << run;
  EXPECT_NE(run.err.find("--t2"), std::string::npos) << run;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(Run, AT1WithoutTemplateAndAtlasHasNoHemispheres) {
  TemporaryFolder folder;
  makePhantom(folder);
  const auto run = explica(
      {"run", folder / "phantom/t1.nii.gz", "--segment.template", "none", "--out", folder / "out"});
  EXPECT_EQ(run.exitCode, 1);
  EXPECT_NE(run.err.find("nothing tells the hemispheres apart; give --atlas"), std::string::npos)
      << run;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

}  // namespace
}  // namespace explica::testing
