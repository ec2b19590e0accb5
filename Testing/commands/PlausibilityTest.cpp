// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// What can be no head is refused; what hardly can be one is done, said and marked.

#include "Explica/IO/VolumeFile.h"
#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <random>

namespace explica::testing {
namespace {

constexpr double kFluid = 30, kGrey = 80, kWhite = 110;

/// White, grey and fluid about each other, with noise; mixed voxels between; 0 outside.
Volume<float> ballHead(double radius, double spacing, const std::array<double, 3>& brightness) {
  Grid grid;
  grid.spacing = Vector::Constant(spacing);
  grid.size.fill(static_cast<int>(2 * radius / spacing) + 6);
  grid.origin = Point::Constant(-0.5 * spacing * (grid.size[0] - 1));
  Volume<float> image(grid, 0.0f);
  std::mt19937 generator(11);
  std::normal_distribution<double> noise(0, 3);
  const auto within = [&](double border, double r) {
    return std::clamp((border - r) / spacing + 0.5, 0.0, 1.0);
  };
  for (std::size_t v = 0; v < image.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const double r = grid.toWorld(Vector(i, j, k)).norm();
    if (r > radius) continue;
    const double white = within(0.7 * radius, r);
    const double tissue = within(0.9 * radius, r);
    image[v] = static_cast<float>(brightness[2] * white + brightness[1] * (tissue - white) +
                                  brightness[0] * (1 - tissue) + noise(generator));
  }
  return image;
}

CommandResult segment(const TemporaryFolder& folder, const std::string& file,
                      const std::vector<std::string>& more = {}) {
  return explica(std::vector<std::string>{"segment", folder / file, "--template", "none", "--out",
                                          folder / "out"} +
                 more);
}

TEST(PlausibilityCommand, ABrainIsPlausible) {
  TemporaryFolder folder;
  io::writeVolume(folder / "t1.nii.gz", ballHead(70, 3, {kFluid, kGrey, kWhite}));
  const auto result = segment(folder, "t1.nii.gz");
  EXPECT_EQ(result.exitCode, 0) << result;
  const auto summary = readJson(folder.path() / "out/summary.json");
  EXPECT_TRUE(summary["plausible"].get<bool>());
  EXPECT_TRUE(summary["flags"].empty());
  EXPECT_NEAR(summary["brain_volume_ml"].get<double>(), 1437, 20);
}

TEST(PlausibilityCommand, WhiteMatterAndFluidExchangedAreFlagged) {
  TemporaryFolder folder;
  ASSERT_EQ(
      explica({"phantom", "cortex", "--size", "32", "--spacing", "2", "--out", folder / "phantom"})
          .exitCode,
      0);
  const std::string labels = folder / "phantom/labels.nii.gz";  // 1 fluid, 2 grey, 3 white
  const auto surface = [&](const std::string& white, const std::vector<std::string>& more = {}) {
    return explica(std::vector<std::string>{"surface", labels, "--white-label", white,
                                            "--grey-label", "2", "--faces", "1000", "--force",
                                            "--out", folder / ("white-" + white)} +
                   more);
  };
  EXPECT_EQ(surface("3").exitCode, 0);
  const CommandResult exchanged = surface("1");
  EXPECT_EQ(exchanged.exitCode, 3) << exchanged;
  const auto summary = readJson(folder / "white-1/summary.json");
  EXPECT_EQ(summary["verdict"], "doubtful");
  EXPECT_EQ(summary["flags"].front()["name"], "exchanged");
  EXPECT_EQ(surface("1", {"--accept", "exchanged"}).exitCode, 0);
}

TEST(PlausibilityCommand, ABrainTooLargeIsFlaggedUnlessAccepted) {
  TemporaryFolder folder;
  io::writeVolume(folder / "t1.nii.gz", ballHead(90, 4, {kFluid, kGrey, kWhite}));
  const auto result = segment(folder, "t1.nii.gz");
  EXPECT_EQ(result.exitCode, 3) << result;
  EXPECT_NE(result.err.find("ml, expected 300 to 2500 ml"), std::string::npos) << result;
  const auto summary = readJson(folder.path() / "out/summary.json");
  EXPECT_FALSE(summary["plausible"].get<bool>());
  ASSERT_EQ(summary["flags"].size(), 1u);
  EXPECT_EQ(summary["flags"][0]["name"], "brain-volume");
  EXPECT_EQ(summary["flags"][0]["high"], 2500);
  EXPECT_EQ(summary["flags"][0]["value"], summary["brain_volume_ml"]);

  const auto accepted = segment(folder, "t1.nii.gz", {"--force", "--accept", "brain-volume"});
  EXPECT_EQ(accepted.exitCode, 0) << accepted;
  const auto after = readJson(folder.path() / "out/summary.json");
  EXPECT_TRUE(after["plausible"].get<bool>());
  EXPECT_TRUE(after["flags"][0]["accepted"].get<bool>());
}

TEST(PlausibilityCommand, VesselsBrighterThanWhiteMatterAreFlagged) {
  TemporaryFolder folder;
  Volume<float> image = ballHead(70, 3, {kFluid, kGrey, kWhite});
  for (std::size_t v = 0; v < image.size(); ++v) {
    const auto [i, j, k] = image.grid.subscripts(v);
    if (image[v] != 0 && i % 6 == 0 && j % 6 == 0) image[v] = 1.4 * kWhite;
  }
  io::writeVolume(folder / "t1.nii.gz", image);
  const auto result = segment(folder, "t1.nii.gz");
  EXPECT_EQ(result.exitCode, 3) << result;
  EXPECT_NE(result.err.find("contrast agent"), std::string::npos) << result;
  const auto summary = readJson(folder.path() / "out/summary.json");
  ASSERT_EQ(summary["flags"].size(), 1u);
  EXPECT_EQ(summary["flags"][0]["name"], "bright-in-brain");
}

TEST(PlausibilityCommand, TooMuchNoiseIsFlagged) {
  TemporaryFolder folder;
  Volume<float> image = ballHead(70, 3, {kFluid, kGrey, kWhite});
  std::mt19937 generator(3);
  std::normal_distribution<float> noise(0, 0.16F * (kWhite - kFluid));
  for (float& value : image.data) {
    if (value != 0) value = std::max(1.0F, value + noise(generator));
  }
  io::writeVolume(folder / "t1.nii.gz", image);
  const auto result = segment(folder, "t1.nii.gz");
  EXPECT_EQ(result.exitCode, 3) << result;
  const auto summary = readJson(folder.path() / "out/summary.json");
  EXPECT_NEAR(summary["noise_of_contrast"].get<double>(), 0.16, 0.03);
  const auto& flags = summary["flags"];
  EXPECT_TRUE(std::any_of(flags.begin(), flags.end(), [](const auto& flag) {
    return flag["name"] == "noise";
  })) << flags;
}

/// A ball of white matter within grey within fluid, by radii in mm.
Volume<float> ballLabels(double white, double tissue, double radius, double spacing) {
  Volume<float> labels = ballHead(radius, spacing, {kFluid, kGrey, kWhite});
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto [i, j, k] = labels.grid.subscripts(v);
    const double r = labels.grid.toWorld(Vector(i, j, k)).norm();
    labels[v] = r > radius ? 0.0f : (r > tissue ? 1.0f : (r > white ? 2.0f : 3.0f));
  }
  return labels;
}

TEST(PlausibilityCommand, AnUnknownNameToAcceptIsAUsageError) {
  TemporaryFolder folder;
  io::writeVolume(folder / "t1.nii.gz", ballHead(20, 2, {kFluid, kGrey, kWhite}));
  const auto result = segment(folder, "t1.nii.gz", {"--accept", "volume"});
  EXPECT_EQ(result.exitCode, 1) << result;
  EXPECT_NE(result.err.find("brain-volume"), std::string::npos) << result;
}

TEST(PlausibilityCommand, InvertedContrastIsRefused) {
  TemporaryFolder folder;
  io::writeVolume(folder / "t2.nii.gz", ballHead(70, 3, {kWhite, kGrey, kFluid}));
  const auto result = segment(folder, "t2.nii.gz");
  EXPECT_EQ(result.exitCode, 2) << result;
  EXPECT_NE(result.err.find("T1"), std::string::npos) << result;
  EXPECT_NE(result.err.find("--accept contrast"), std::string::npos) << result;
  EXPECT_EQ(segment(folder, "t2.nii.gz", {"--accept", "contrast"}).exitCode, 0);
}

TEST(PlausibilityCommand, ACtIsRefused) {
  TemporaryFolder folder;
  Volume<float> image = ballHead(70, 4, {kFluid, kGrey, kWhite});
  for (float& value : image.data) value = value == 0 ? -1000 : value;
  io::writeVolume(folder / "ct.nii.gz", image);
  const auto result = segment(folder, "ct.nii.gz");
  EXPECT_EQ(result.exitCode, 2) << result;
  EXPECT_NE(result.err.find("CT"), std::string::npos) << result;
}

TEST(PlausibilityCommand, LabelsAreNoT1AndAT1IsNoLabels) {
  TemporaryFolder folder;
  Volume<float> labels = ballHead(40, 2, {kFluid, kGrey, kWhite});
  for (float& value : labels.data) value = value == 0 ? 0 : (value < 60 ? 1 : (value < 95 ? 2 : 3));
  io::writeVolume(folder / "labels.nii.gz", labels);
  const auto segmented = segment(folder, "labels.nii.gz");
  EXPECT_EQ(segmented.exitCode, 2) << segmented;
  EXPECT_NE(segmented.err.find("labels"), std::string::npos) << segmented;

  Volume<float> image = ballHead(40, 2, {kFluid, kGrey, kWhite});
  for (float& value : image.data) value = std::round(2 * value);
  io::writeVolume(folder / "t1.nii.gz", image);
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"thickness", folder / "t1.nii.gz", "--inner", "220", "--tissue",
                                 "160"},
        std::vector<std::string>{"surface", folder / "t1.nii.gz", "--white-label", "220"}}) {
    const auto result = explica(words + std::vector<std::string>{"--out", folder / "labels-out"});
    EXPECT_EQ(result.exitCode, 2) << result;
    EXPECT_NE(result.err.find("explica segment"), std::string::npos) << result;
  }
}

TEST(PlausibilityCommand, ACortexTooThickIsRedInTheReportAndFailsItsRow) {
  TemporaryFolder folder;
  // Half of a head's thickness is grey: 18 mm.
  Volume<float> labels = ballHead(60, 3, {1, 2, 3});
  for (float& value : labels.data) value = std::clamp(std::round(value), 0.0f, 3.0f);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto [i, j, k] = labels.grid.subscripts(v);
    const double r = labels.grid.toWorld(Vector(i, j, k)).norm();
    labels[v] = r > 60 ? 0 : (r > 54 ? 1 : (r > 36 ? 2 : 3));
  }
  io::writeVolume(folder / "seg.nii.gz", labels);
  const std::string run = folder / "study/runs/sub-01_hemi-L";
  const auto result = explica({"run", folder / "seg.nii.gz", "--kind", "labels", "--steps",
                               "surface,report", "--surface.faces", "2000", "--out", run});
  EXPECT_EQ(result.exitCode, 3) << result;
  const auto summary = readJson(std::filesystem::path(run) / "summary.json");
  EXPECT_FALSE(summary["plausible"].get<bool>());
  EXPECT_EQ(summary["flags"][0]["name"], "thickness-mean");
  EXPECT_EQ(summary["flags"][0]["step"], "surface");
  EXPECT_NE(readText(std::filesystem::path(run) / "report.html").find("Thickness mean:"),
            std::string::npos);

  std::filesystem::create_directories(folder / "data");
  writeText(folder / "data/dataset_description.json", R"({"Name": "a", "BIDSVersion": "1.8.0"})");
  const auto group = explica({"bids", folder / "data", folder / "study", "group"});
  EXPECT_EQ(group.exitCode, 0) << group;
  const std::string table = readText(folder.path() / "study/study.tsv");
  EXPECT_NE(table.find("implausible (surface)"), std::string::npos) << table;
}

/// Balls of white within grey within fluid as a T1, by radii in mm.
Volume<float> ballT1(double white, double tissue, double radius, double spacing) {
  constexpr std::array<double, 4> kBrightness = {0, kFluid, kGrey, kWhite};
  Volume<float> image = ballHead(radius, spacing, {kFluid, kGrey, kWhite});
  const Volume<float> usual = ballLabels(0.7 * radius, 0.9 * radius, radius, spacing);
  const Volume<float> labels = ballLabels(white, tissue, radius, spacing);
  for (std::size_t v = 0; v < image.size(); ++v) {  // the same noise
    if (image[v] == 0) continue;
    image[v] += static_cast<float>(kBrightness[static_cast<std::size_t>(labels[v])] -
                                   kBrightness[static_cast<std::size_t>(usual[v])]);
    image[v] = std::max(1.0f, image[v]);
  }
  return image;
}

/// A made input, and the command whose number it puts beyond a limit.
struct Beyond {
  std::string limit;
  bool refused;  ///< else flagged
  std::function<Volume<float>()> input;
  std::vector<std::string> words;  ///< of the command, {input} for the file

  friend std::ostream& operator<<(std::ostream& out, const Beyond& beyond) {
    return out << beyond.limit;
  }
};

std::vector<Beyond> beyondEachLimit() {
  const std::vector<std::string> segment = {"segment", "{input}", "--template", "none"};
  const std::vector<std::string> surface = {"surface",     "{input}", "--preset",
                                            "three-class", "--faces", "2000"};
  return {
      {"hounsfield", true,
       [] {
         Volume<float> image = ballHead(70, 4, {kFluid, kGrey, kWhite});
         for (float& value : image.data) value = value == 0 ? -1000 : value;
         return image;
       },
       segment},
      {"labels", true, [] { return ballLabels(52, 68, 75, 3); }, segment},
      {"contrast", true,
       [] {
         return ballHead(70, 3, {kWhite, kGrey, kFluid});
       },
       segment},
      {"brain-volume", false,
       [] {
         return ballHead(90, 4, {kFluid, kGrey, kWhite});
       },
       segment},
      {"grey-share", false, [] { return ballT1(54, 56, 70, 3); }, segment},
      {"white-share", false, [] { return ballT1(31, 53, 60, 3); }, segment},
      {"thickness-mean", false, [] { return ballLabels(36, 54, 60, 3); }, surface},
      {"without-thickness",
       false,
       [] {  // grey matter in the middle of the white touches no fluid
         Volume<float> labels = ballLabels(40, 44, 48, 2);
         for (std::size_t v = 0; v < labels.size(); ++v) {
           const auto [i, j, k] = labels.grid.subscripts(v);
           if (labels.grid.toWorld(Vector(i, j, k)).norm() < 14) labels[v] = 2;
         }
         return labels;
       },
       {"thickness", "{input}", "--inner", "3", "--tissue", "2"}},
      {"corrected", false,
       [] {  // white matter's border is noise
         Volume<float> labels = ballLabels(40, 46, 50, 2);
         std::mt19937 random(1);
         for (std::size_t v = 0; v < labels.size(); ++v) {
           const auto [i, j, k] = labels.grid.subscripts(v);
           const double r = labels.grid.toWorld(Vector(i, j, k)).norm();
           if (std::abs(r - 40) < 4 && random() % 3 == 0) labels[v] = labels[v] == 3 ? 2 : 3;
         }
         return labels;
       },
       surface},
  };
}

class EveryLimit : public ::testing::TestWithParam<Beyond> {};

TEST_P(EveryLimit, IsRefusedOrFlaggedUnlessAccepted) {
  const Beyond& beyond = GetParam();
  TemporaryFolder folder;
  io::writeVolume(folder / "input.nii.gz", beyond.input());
  std::vector<std::string> words = beyond.words;
  for (std::string& word : words) {
    if (word == "{input}") word = folder / "input.nii.gz";
  }
  const std::string out = folder / "out";
  const auto result = explica(words + std::vector<std::string>{"--out", out});
  if (beyond.refused) {
    EXPECT_EQ(result.exitCode, 2) << result;
    EXPECT_NE(result.err.find("--accept " + beyond.limit), std::string::npos) << result;
    EXPECT_FALSE(std::filesystem::exists(out + "/summary.json"));
  } else {
    EXPECT_EQ(result.exitCode, 3) << result;
    const auto flags = readJson(std::filesystem::path(out) / "summary.json")["flags"];
    ASSERT_EQ(flags.size(), 1u) << result;
    EXPECT_EQ(flags[0]["name"], beyond.limit);
    const double value = flags[0]["value"].get<double>();
    const bool below = flags[0]["low"].is_number() && value < flags[0]["low"].get<double>();
    const bool above = flags[0]["high"].is_number() && value > flags[0]["high"].get<double>();
    EXPECT_TRUE(below || above) << flags;
    ASSERT_EQ(explica({"report", out}).exitCode, 0);
    EXPECT_NE(readText(std::filesystem::path(out) / "report.html").find("class='badge bad'"),
              std::string::npos);
  }
  const auto accepted =
      explica(words + std::vector<std::string>{"--force", "--accept", beyond.limit, "--out", out});
  EXPECT_EQ(accepted.exitCode, 0) << accepted;
}

INSTANTIATE_TEST_SUITE_P(MadeInputs, EveryLimit, ::testing::ValuesIn(beyondEachLimit()),
                         [](const auto& made) {
                           std::string name = made.param.limit;
                           std::erase(name, '-');
                           return name;
                         });

}  // namespace
}  // namespace explica::testing
