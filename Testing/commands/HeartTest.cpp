// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// explica heart: what users type and what they get.

#include "Explica/IO/VolumeFile.h"
#include "Explica/Provenance/Digest.h"
#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

/// Columns of a tab-separated table by name.
std::map<std::string, std::vector<std::string>> tableOf(const fs::path& file) {
  std::istringstream in(readText(file));
  std::vector<std::string> names;
  std::map<std::string, std::vector<std::string>> columns;
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells(line);
    std::size_t c = 0;
    for (std::string cell; std::getline(cells, cell, '\t'); ++c) {
      if (columns.size() < c + 1 && names.size() < c + 1) {
        names.push_back(cell);
      } else {
        columns[names[c]].push_back(cell);
      }
    }
  }
  return columns;
}

/// A beat of thick slices in {folder}/beat.
void makeBeat(const TemporaryFolder& folder, const std::vector<std::string>& more = {}) {
  std::vector<std::string> words = {"phantom", "ventricle", "--size", "90",       "--spacing",
                                    "1.4",     "--slice",   "8",      "--frames", "2"};
  words.insert(words.end(), more.begin(), more.end());
  words.insert(words.end(), {"--out", folder / "beat"});
  const auto made = explica(words);
  ASSERT_EQ(made.exitCode, 0) << made;
}

std::vector<std::string> heart(const TemporaryFolder& folder,
                               const std::vector<std::string>& more) {
  std::vector<std::string> words = {"heart", folder / "beat/frame-0000.nii.gz",
                                    folder / "beat/frame-0001.nii.gz"};
  words.insert(words.end(), more.begin(), more.end());
  words.insert(words.end(), {"--out", folder / "out", "--force"});
  return words;
}

}  // namespace

TEST(HeartCommand, AClosedShellIsFlaggedAsNoVentricle) {
  const TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "shell", "--size", "32", "--out", folder / "shell"}).exitCode, 0);
  const auto shell = explica({"heart", folder / "shell/labels.nii.gz", "--preset", "none",
                              "--cavity", "1", "--wall", "2", "--out", folder / "out"});
  EXPECT_EQ(shell.exitCode, 3) << shell;
  EXPECT_NE(shell.err.find("no ventricle"), std::string::npos) << shell;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["plausible"], false);
  EXPECT_EQ(summary["flags"][0]["name"], "closed-wall");
  makeBeat(folder);
  const auto beat = explica(heart(folder, {}));
  EXPECT_EQ(beat.exitCode, 0) << beat;
  EXPECT_GT(readJson(folder / "out/summary.json")["open_share_ed"], 0.05);
}

TEST(HeartCommand, TellsVolumesThicknessAndThickeningOfABeat) {
  TemporaryFolder folder;
  makeBeat(folder, {"--ejection", "0.4"});
  const auto made = explica(heart(folder, {}));
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_NEAR(summary["ejection_fraction_percent"].get<double>(), 40, 1);
  EXPECT_EQ(summary["orientation"], "right ventricle");
  EXPECT_EQ(summary["measured"], "by slice");
  EXPECT_NEAR(summary["axis_angle_deg"].get<double>(), 0, 1);
  EXPECT_EQ(summary["frame_es"], 1);
  const auto frames = tableOf(folder / "out/frames.tsv");
  const auto exact = tableOf(folder / "beat/frames_exact.tsv");
  for (int f = 0; f < 2; ++f) {
    const double cavity = std::stod(exact.at("cavity_volume_ml")[f]);
    EXPECT_NEAR(std::stod(frames.at("cavity_volume_ml")[f]), cavity, 0.02 * cavity);
    EXPECT_NEAR(std::stod(frames.at("mass_g")[f]) / std::stod(exact.at("mass_g")[f]), 1, 0.02);
  }
  const auto segments = tableOf(folder / "out/segments.tsv");
  const auto truth = tableOf(folder / "beat/segments_exact.tsv");
  ASSERT_EQ(segments.at("segment").size(), 34U);
  EXPECT_EQ(segments.at("name")[1], "basal anteroseptal");
  for (int row = 0; row < 12; ++row) {
    EXPECT_NEAR(std::stod(segments.at("thickness")[row]), std::stod(truth.at("thickness")[row]),
                0.3);
    EXPECT_NEAR(std::stod(segments.at("thickening")[17 + row]),
                std::stod(truth.at("thickening")[16 + row]), 3);
  }
  for (const char* file : {"bullseye.svg", "slices_ed.svg", "slices_es.svg"}) {
    EXPECT_EQ(readText(folder / ("out/" + std::string(file))).find("<svg"), 0U) << file;
  }
  for (const char* file : {"bullseye.png", "thickness_frame-0001.nii.gz", "left_out.nii.gz"}) {
    EXPECT_TRUE(fs::exists(folder / ("out/" + std::string(file)))) << file;
  }
  const auto of = io::readLabels(folder / "out/segments.nii.gz").volume;
  EXPECT_EQ(*std::max_element(of.data.begin(), of.data.end()), 17);

  // What was judged of a heart stands first in its report, which may go to a folder of its own.
  const auto report = explica({"report", folder / "out", "--out", folder / "shown"});
  ASSERT_EQ(report.exitCode, 0) << report;
  const std::string page = readText(folder / "shown/report.html");
  EXPECT_NE(page.find("Open at its base:"), std::string::npos);
  EXPECT_NE(page.find("by right ventricle"), std::string::npos);
  EXPECT_NE(page.find("Volume of the cavity"), std::string::npos);
  EXPECT_EQ(page.find("Nothing was found that could be judged"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder / "out/report.html"));
  EXPECT_EQ(explica({"report", folder / "out", "--out", folder / "shown"}).exitCode, 2);
}

/// The same voxels with another axis last.
template <class T>
Volume<T> storedAs(const Volume<T>& volume, const std::array<int, 3>& axes) {
  Grid grid = volume.grid;
  for (int a = 0; a < 3; ++a) {
    grid.size[a] = volume.grid.size[axes[a]];
    grid.spacing[a] = volume.grid.spacing[axes[a]];
    grid.direction.col(a) = volume.grid.direction.col(axes[a]);
  }
  Volume<T> stored(grid);
  for (std::size_t v = 0; v < volume.size(); ++v) {
    const auto at = volume.grid.subscripts(v);
    stored(at[axes[0]], at[axes[1]], at[axes[2]]) = volume[v];
  }
  return stored;
}

TEST(HeartCommand, SlicesMayBeStackedAlongAnyAxis) {
  const TemporaryFolder folder;
  makeBeat(folder, {"--tilt", "8"});
  ASSERT_EQ(explica(heart(folder, {})).exitCode, 0);
  fs::rename(folder / "out", folder / "asked");
  std::vector<Volume<Label>> frames;
  for (const char* name : {"beat/frame-0000.nii.gz", "beat/frame-0001.nii.gz"}) {
    frames.push_back(io::readLabels(folder / name).volume);
  }
  for (const auto& axes : {std::array{2, 0, 1}, {1, 2, 0}}) {
    io::writeVolume(folder / "beat/frame-0000.nii.gz", storedAs(frames[0], axes));
    io::writeVolume(folder / "beat/frame-0001.nii.gz", storedAs(frames[1], axes));
    const auto run = explica(heart(folder, {}));
    ASSERT_EQ(run.exitCode, 0) << run;
    for (const std::string table : {"frames.tsv", "segments.tsv", "slices.tsv"}) {
      EXPECT_EQ(readText(folder / ("out/" + table)), readText(folder / ("asked/" + table)));
    }
    const std::string map = "thickness_frame-0000.nii.gz";
    const auto found = io::readScalars(folder / ("out/" + map)).volume;
    const auto asked = storedAs(io::readScalars(folder / ("asked/" + map)).volume, axes);
    EXPECT_TRUE(sameGrid(found.grid, asked.grid));
    EXPECT_EQ(found.data, asked.data);
    EXPECT_EQ(explica(heart(folder, {"--rv-insertion-image-axis", "i-"})).exitCode, 2);
  }
}

TEST(HeartCommand, ImagesLieBeneathTheBoundariesAndBeat) {
  const TemporaryFolder folder;
  makeBeat(folder);
  const std::string first = folder / "beat/frame-0000.nii.gz";
  const std::string second = folder / "beat/frame-0001.nii.gz";  // labels are an image, too
  const auto made = explica(heart(folder, {"--image", first, second}));
  ASSERT_EQ(made.exitCode, 0) << made;
  for (const char* file : {"slices_ed.svg", "slices_es.svg"}) {
    const std::string drawing = readText(folder / ("out/" + std::string(file)));
    EXPECT_NE(drawing.find("<image"), std::string::npos) << file;
    EXPECT_NE(drawing.find("boundaries on the image"), std::string::npos) << file;
    EXPECT_NE(drawing.find("<path"), std::string::npos) << file;
    EXPECT_EQ(drawing.find("left out: opening"), std::string::npos) << file;
  }
  EXPECT_EQ(readText(folder / "out/slices.gif").find("GIF89a"), 0U);
  const auto report = explica({"report", folder / "out", "--out", folder / "shown"});
  ASSERT_EQ(report.exitCode, 0) << report;
  const std::string page = readText(folder / "shown/report.html");
  EXPECT_NE(page.find("image/gif"), std::string::npos);
  EXPECT_NE(page.find("href='#pictures'"), std::string::npos);
  EXPECT_LT(page.find("<h3>Slices over time"), page.find("id='numbers'")) << "beside the verdict";
  EXPECT_NE(page.find("48 to 71 % (healthy women 61 (SD 5), men 58 (SD 5) %"), std::string::npos);
  if (fs::exists("/usr/bin/chromium") && fs::exists("/usr/bin/chromedriver")) {
    const auto browser =
        runProgram({"/usr/bin/python3", EXPLICA_SOURCE_DIR "/Testing/commands/report_drawings.py",
                    folder / "shown/report.html"});
    EXPECT_EQ(browser.exitCode, 0) << browser;
  }
  // One frame for two, and one of other voxels.
  const auto few = explica(heart(folder, {"--image", first}));
  EXPECT_EQ(few.exitCode, 2) << few;
  EXPECT_NE(few.err.find("1 frames, but 2 of labels"), std::string::npos) << few;
  ASSERT_EQ(explica({"phantom", "shell", "--size", "32", "--out", folder / "shell"}).exitCode, 0);
  const auto other = explica(heart(folder, {"--image", first, folder / "shell/labels.nii.gz"}));
  EXPECT_EQ(other.exitCode, 2) << other;
  EXPECT_NE(other.err.find("lie elsewhere"), std::string::npos) << other;
}

TEST(HeartCommand, FindsTheFramesOrTakesThem) {
  TemporaryFolder folder;
  makeBeat(folder);
  // The other way round: the second file is end-diastole.
  std::vector<std::string> words = {"heart",
                                    folder / "beat/frame-0001.nii.gz",
                                    folder / "beat/frame-0000.nii.gz",
                                    "--phases",
                                    "ED,ES",
                                    "--out",
                                    folder / "out"};
  ASSERT_EQ(explica(words).exitCode, 0);
  const auto frames = tableOf(folder / "out/frames.tsv");
  EXPECT_EQ(frames.at("frame"), (std::vector<std::string>{"1", "0"}));
  EXPECT_EQ(frames.at("phase"), (std::vector<std::string>{"ED", "ES"}));
  EXPECT_EQ(explica(heart(folder, {"--phases", "0,5"})).exitCode, 1);
  EXPECT_EQ(explica(heart(folder, {"--phases", "first"})).exitCode, 1);
  EXPECT_EQ(explica(heart(folder, {"--phases", "1,1"})).exitCode, 0);
}

TEST(HeartCommand, WithoutRightVentricleItIsNotOrientedAndSaysSo) {
  TemporaryFolder folder;
  makeBeat(folder);
  const std::vector<std::string> labels = {"--cavity", "1", "--wall", "2"};
  const auto made = explica(heart(folder, labels));
  ASSERT_EQ(made.exitCode, 0) << made;
  EXPECT_NE(made.err.find("have no anatomical names"), std::string::npos) << made;
  EXPECT_EQ(tableOf(folder / "out/segments.tsv").at("name")[1], "basal 2");
  EXPECT_NE(readText(folder / "out/bullseye.svg").find("not oriented"), std::string::npos);
  auto axis = labels;
  axis.insert(axis.end(), {"--rv-insertion-image-axis", "i-"});
  ASSERT_EQ(explica(heart(folder, axis)).exitCode, 0);
  EXPECT_EQ(tableOf(folder / "out/segments.tsv").at("name")[1], "basal anteroseptal");
}

TEST(HeartCommand, RefusesAPointFarFromTheHeart) {
  TemporaryFolder folder;
  makeBeat(folder);
  const auto made = explica(heart(folder, {"--rv-insertion", "9999,0,0"}));
  EXPECT_EQ(made.exitCode, 2);
  EXPECT_NE(made.err.find("from the wall"), std::string::npos) << made;
  EXPECT_NE(made.err.find("ITK-SNAP"), std::string::npos) << made;
}

TEST(HeartCommand, AFrameWithoutWallIsSaidAndLeftOut) {
  const fs::path data = fs::path(EXPLICA_REAL_DATA) / "lv_sunnybrook_SCD0000101";
  if (!fs::exists(data)) GTEST_SKIP() << "skipped: no real data";
  TemporaryFolder folder;
  const auto made = explica({"heart", (data / "ED_label.nii.gz").string(),
                             (data / "ES_label.nii.gz").string(), "--out", folder / "out"});
  ASSERT_EQ(made.exitCode, 0) << made;
  EXPECT_NE(made.err.find("frame 1 is left out of thickness and mass: it has no wall"),
            std::string::npos)
      << made;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_NEAR(summary["ejection_fraction_percent"].get<double>(), 26.3, 0.1);
  const auto slices = tableOf(folder / "out/slices.tsv");
  EXPECT_EQ(slices.at("kind")[0], "open");
  EXPECT_EQ(slices.at("voxels")[0], "0");
}

TEST(HeartCommand, ReadsAllFramesOfOneFile) {
  TemporaryFolder folder;
  makeBeat(folder);
  std::vector<VolumeOnDemand<float>> frames;
  for (const char* name : {"frame-0000.nii.gz", "frame-0001.nii.gz"}) {
    auto loaded = io::readScalars(folder / ("beat/" + std::string(name))).volume;
    VolumeOnDemand<float> frame;
    frame.grid = loaded.grid;
    frame.end = loaded.size();
    frame.fill = [loaded](std::size_t first, std::size_t count, float* to) {
      std::copy_n(loaded.data.begin() + static_cast<std::ptrdiff_t>(first), count, to);
    };
    frames.push_back(frame);
  }
  io::writeFrames(folder / "beat.nii.gz", frames);
  ASSERT_EQ(explica({"heart", folder / "beat.nii.gz", "--out", folder / "one"}).exitCode, 0);
  ASSERT_EQ(explica(heart(folder, {})).exitCode, 0);
  EXPECT_EQ(readText(folder / "one/segments.tsv"), readText(folder / "out/segments.tsv"));
}

namespace {

/// Writes the labels that `labelAt` gives to places (mm) of a grid about the origin.
template <class LabelAt>
void writeLabels(const std::string& path, double pixel, double slice, const LabelAt& labelAt) {
  Grid grid;
  grid.size = {static_cast<int>(130 / pixel), static_cast<int>(130 / pixel),
               static_cast<int>(72 / slice)};
  grid.spacing = Vector(pixel, pixel, slice);
  for (int c = 0; c < 3; ++c) grid.origin[c] = -0.5 * (grid.size[c] - 1) * grid.spacing[c];
  Volume<Label> labels(grid);
  std::size_t v = 0;
  for (int k = 0; k < grid.size[2]; ++k) {
    for (int j = 0; j < grid.size[1]; ++j) {
      for (int i = 0; i < grid.size[0]; ++i) labels[v++] = labelAt(grid.toWorld(Vector(i, j, k)));
    }
  }
  io::writeVolume(path, labels);
}

}  // namespace

TEST(HeartCommand, TheRightVentriclesWallIsPlainTissueWithOpenEnds) {
  // A crescent of 3 mm about the right ventricle (3), that ends at the left one's wall (2).
  const TemporaryFolder folder;
  const auto heartAt = [](const Point& p) -> Label {
    const double left = std::hypot(p[0], p[1]), right = std::hypot(p[0] + 24, p[1]);
    if (left < 28) return left < 20 ? 1 : 2;
    return right < 28 ? 3 : right < 31 ? 4 : 0;
  };
  for (const auto& [pixel, slice] : {std::pair{1.0, 1.0}, {1.4, 8.0}}) {
    writeLabels(folder / "heart.nii.gz", pixel, slice, heartAt);
    const auto made =
        explica({"thickness", folder / "heart.nii.gz", "--inner", "3", "--tissue", "4",
                 "--insulated", "1,2", "--open-ends", "--out", folder / "out", "--force"});
    ASSERT_EQ(made.exitCode, 0) << made;
    const auto summary = readJson(folder / "out/summary.json");
    EXPECT_NEAR(summary["thickness_mean_columns"].get<double>(), 3, 0.06) << slice;
    // Pixels of 1.4 mm make steps of the wall's borders: a quarter of one to either side.
    EXPECT_NEAR(summary["thickness_p05"].get<double>(), 3, 0.25 * std::max(pixel, 1.4)) << slice;
    EXPECT_NEAR(summary["thickness_p95"].get<double>(), 3, 0.25 * std::max(pixel, 1.4)) << slice;
  }
}

TEST(HeartCommand, AThinAtrialWallWithAMouthIsPlainTissueWithOpenEnds) {
  // A sphere of 22 mm with a wall of 2 mm, open above 12 mm.
  const TemporaryFolder folder;
  writeLabels(folder / "atrium.nii.gz", 1, 1, [](const Point& p) -> Label {
    if (p[2] > 12) return 0;
    return p.norm() < 22 ? 1 : p.norm() < 24 ? 2 : 0;
  });
  const auto made = explica({"thickness", folder / "atrium.nii.gz", "--inner", "1", "--tissue", "2",
                             "--open-ends", "--out", folder / "out"});
  ASSERT_EQ(made.exitCode, 0) << made;
  EXPECT_NEAR(readJson(folder / "out/summary.json")["thickness_mean_columns"].get<double>(), 2,
              0.05);
}

TEST(HeartCommand, AFolderOfHeartsBecomesATableOfPeople) {
  const TemporaryFolder folder;
  makeBeat(folder);
  for (const std::string& name : {std::string("1"), std::string("2")}) {
    const fs::path place = folder / ("data/sub-" + name + "/anat/sub-" + name + "_frame-");
    fs::create_directories(place.parent_path());
    fs::copy_file(folder / "beat/frame-0000.nii.gz", place.string() + "ED_dseg.nii.gz");
    fs::copy_file(folder / "beat/frame-0001.nii.gz", place.string() + "ES_dseg.nii.gz");
  }
  fs::create_directories(folder / "data/sub-3");
  writeText(folder / "data/sub-3/sub-3_dseg.nii.gz", "nothing of the kind");
  writeText(folder / "data/participants.tsv", "participant_id\tsex\nsub-2\tF\n");
  const std::vector<std::string> words = {"study", "hearts", folder / "data", folder / "out"};
  const auto made = explica(words);
  EXPECT_EQ(made.exitCode, 3) << made;
  EXPECT_NE(made.err.find("1 of 3 hearts failed: sub-3"), std::string::npos) << made;
  auto table = tableOf(folder / "out/hearts.tsv");
  EXPECT_EQ(table["participant_id"], (std::vector<std::string>{"sub-1", "sub-2", "sub-3"}));
  EXPECT_EQ(table["sex"], (std::vector<std::string>{"n/a", "F", "n/a"}));
  EXPECT_EQ(table["state"][1], "done");
  EXPECT_EQ(table["state"][2].find("failed: "), 0U) << table["state"][2];
  const auto single = explica({"heart", folder / "beat/frame-0000.nii.gz",
                               folder / "beat/frame-0001.nii.gz", "--out", folder / "single"});
  ASSERT_EQ(single.exitCode, 0) << single;
  const auto summary = readJson(folder / "single/summary.json");
  EXPECT_NEAR(std::stod(table["ejection_fraction_percent"][0]),
              summary["ejection_fraction_percent"].get<double>(), 1e-9);
  const auto segments = tableOf(folder / "single/segments.tsv");
  EXPECT_EQ(table["segment_08_thickness_ed"][1], segments.at("thickness")[7]);
  EXPECT_EQ(table["segment_08_thickening"][1], segments.at("thickening")[17 + 7]);
  // What has not changed is kept, a heart that is mended is done, and its row says so.
  const auto before = fs::last_write_time(folder / "out/sub-1/heart/segments.nii.gz");
  fs::copy_file(folder / "beat/frame-0000.nii.gz", folder / "data/sub-3/sub-3_dseg.nii.gz",
                fs::copy_options::overwrite_existing);
  const auto again = explica(words);
  EXPECT_EQ(again.exitCode, 0) << again;
  EXPECT_EQ(fs::last_write_time(folder / "out/sub-1/heart/segments.nii.gz"), before);
  EXPECT_EQ(tableOf(folder / "out/hearts.tsv")["state"][2], "done");
  EXPECT_FALSE(fs::exists(folder / "out/sub-3/heart/problem.txt"));
  EXPECT_NE(readText(folder / "out/index.html").find("sub-2/heart/bullseye.svg"),
            std::string::npos);
  const auto nobody =
      explica({"study", "hearts", folder / "data", folder / "out", "--participant-label", "9"});
  EXPECT_EQ(nobody.exitCode, 2) << nobody;
}

TEST(HeartCommand, APersonOfAStudyIsTheSameWithAndWithoutSub) {
  const TemporaryFolder folder;
  makeBeat(folder);
  fs::create_directories(folder / "data/sub-1");
  fs::copy_file(folder / "beat/frame-0000.nii.gz", folder / "data/sub-1/sub-1_dseg.nii.gz");
  const auto only = [&](const std::string& label) {
    return explica(
        {"study", "hearts", folder / "data", folder / "out", "--participant-label", label});
  };
  ASSERT_EQ(only("1").exitCode, 0);
  // Another machine is at work on this person.
  const std::string share = provenance::sha256Of("1_").substr(0, 16);
  writeText(folder / ("out/.explica-lock-" + share),
            R"({"host": "elsewhere", "pid": 1, "process_start": "1",
                "started": "2026-01-01T00:00:00Z", "command": "study hearts"})");
  for (const char* label : {"1", "sub-1"}) {
    const auto refused = only(label);
    EXPECT_EQ(refused.exitCode, 4) << refused;
    EXPECT_NE(refused.err.find("elsewhere"), std::string::npos) << refused;
  }
}

}  // namespace explica::testing
