// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Heads of full size: out of the skull, to a thickness, through a study; of a macaque.

#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"
#include "Explica/Testing/Grids.h"
#include "QuickRuns.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <random>
#include <set>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

const fs::path kTemplates = "/usr/share/mricron/templates";

CommandResult patiently(const std::vector<std::string>& words) {
  CommandSetting setting;
  setting.timeout = 1800;
  return explica(words, setting);
}

double numberOf(const fs::path& folder, const char* name) {
  return readJson(folder / "summary.json")[name].get<double>();
}

class WholeHead : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(kTemplates)) GTEST_SKIP() << "skipped: no templates of mricron-data";
  }

  /// Left surfaces of a segmentation, their borders placed by its image.
  CommandResult surface(const fs::path& image) {
    const std::string side = folder_ / "segment/left/";
    return patiently({"surface", "--inner-level", side + "white_share.nii.gz", "--outer-level",
                      side + "tissue_share.nii.gz", "--insulated-mask", side + "cut.nii.gz",
                      "--hemisphere", "L", "--faces", "60000", "--image", image.string(), "--fluid",
                      std::to_string(numberOf(folder_ / "segment", "fluid_of_white")), "--out",
                      folder_ / "surface"});
  }

  TemporaryFolder folder_;
};

/// Voxels twice as large along every axis.
Grid halved(const Grid& grid) {
  Grid half = grid;
  half.origin = grid.toWorld(Vector::Constant(0.5));
  half.spacing *= 2;
  for (int& n : half.size) n = (n + 1) / 2;
  return half;
}

/// Compares a mask of the template's head with that of another program.
void expectTheBrainOfColin27(const fs::path& segment) {
  const auto ours = io::readLabels(segment / "brain_mask.nii.gz").volume;
  const auto known = io::readScalars(kTemplates / "ch2bet.nii.gz").volume;
  ASSERT_EQ(ours.size(), known.size());
  // ch2bet ends at the cortex, the mask at the skull: it has all of the brain, and fluid beside it.
  const auto tissue = io::readLabels(segment / "seg.nii.gz").volume;
  double both = 0, sum = 0, brain = 0, lost = 0;
  for (std::size_t v = 0; v < ours.size(); ++v) {
    const bool inBrain = known[v] > 0;
    const bool kept = ours[v] != 0 && (tissue[v] != 1 || inBrain);
    brain += inBrain;
    lost += inBrain && ours[v] == 0;
    both += kept && inBrain;
    sum += kept + inBrain;
  }
  std::printf("of ch2bet lost %.4f, Dice without the fluid beside it %.4f\n", lost / brain,
              2 * both / sum);
  EXPECT_LT(lost / brain, 0.005);
  EXPECT_GT(2 * both / sum, 0.96);
}

/// T1 of a label map in voxels of 2 mm, by the means of real T1s by label (white matter is 160);
/// shaded, with noise of 3 %.
Volume<float> simulatedHead(const Volume<Label>& labels) {
  static const std::map<Label, float> kMean = {
      {0, 3},    {2, 160},   {3, 96},   {4, 44},   {5, 44},    {7, 136},  {8, 88},    {10, 130},
      {11, 100}, {12, 124},  {13, 152}, {14, 44},  {15, 44},   {16, 130}, {17, 96},   {18, 96},
      {24, 44},  {26, 96},   {28, 142}, {41, 160}, {42, 96},   {43, 44},  {44, 44},   {46, 136},
      {47, 88},  {49, 130},  {50, 100}, {51, 124}, {52, 152},  {53, 96},  {54, 96},   {58, 96},
      {60, 142}, {502, 126}, {506, 18}, {507, 94}, {508, 117}, {509, 70}, {511, 114}, {512, 68},
      {514, 48}, {515, 30},  {516, 94}, {530, 144}};
  std::mt19937 random(9);
  std::normal_distribution<float> noise(0, 0.03F * 160);
  Volume<float> head(halved(labels.grid), 0.0F);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto [i, j, k] = labels.grid.subscripts(v);
    const auto mean = kMean.find(labels[v]);
    head(i / 2, j / 2, k / 2) += 0.125F * (mean == kMean.end() ? 80.0F : mean->second);
  }
  for (std::size_t v = 0; v < head.size(); ++v) {
    const auto [i, j, k] = head.grid.subscripts(v);
    const float shaded = head[v] * std::exp(0.2F * std::sin(0.03F * static_cast<float>(i + j)));
    head[v] = std::hypot(shaded + noise(random), noise(random));
  }
  return head;
}

// Cut by the mask of a template, 8 to 12 % of the cortex was lost without a word.
TEST_F(WholeHead, KeepsTheCortexOfAPersonOfKnownTissue) {
  const fs::path person = fs::path(EXPLICA_REAL_DATA) / "synthseg_people/training_seg_04.nii.gz";
  if (!fs::exists(person)) GTEST_SKIP() << "skipped: no real data";
  const auto labels = io::readLabels(person).volume;
  io::writeVolume(folder_ / "T1.nii.gz", simulatedHead(labels));
  const auto run = patiently({"segment", folder_ / "T1.nii.gz", "--out", folder_ / "segment"});
  ASSERT_EQ(run.exitCode, 0) << run;
  const auto mask = io::readLabels(folder_ / "segment/brain_mask.nii.gz").volume;
  double cortex = 0, lost = 0, both = 0, sum = 0;
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto [i, j, k] = labels.grid.subscripts(v);
    const bool kept = mask(i / 2, j / 2, k / 2) != 0;
    const bool brain = labels[v] > 0 && labels[v] < 500;
    if (labels[v] == 3 || labels[v] == 42) {
      cortex += 1;
      lost += kept ? 0 : 1;
    }
    both += kept && brain;
    sum += kept + brain;
  }
  std::printf("cortex lost %.4f, Dice %.4f\n", lost / cortex, 2 * both / sum);
  EXPECT_LT(lost / cortex, 0.005);
  EXPECT_GT(2 * both / sum, 0.94);
  EXPECT_LT(numberOf(folder_ / "segment", "brain_border_open_share"), 0.01);
}

TEST_F(WholeHead, Colin27IsAsThickAsOthers) {
  const fs::path image = kTemplates / "ch2bet.nii.gz";
  const auto run = patiently(
      {"segment", image, "--atlas", kTemplates / "aal.nii.gz", "--out", folder_ / "segment"});
  ASSERT_EQ(run.exitCode, 0) << run;
  const auto made = surface(image);
  ASSERT_EQ(made.exitCode, 0) << made;
  // By the nearest distance, as the means of others are; he was scaled to MNI's template, whose
  // sides are 1.07 times those of a brain (Lancaster et al. 2007, Hum. Brain Mapp. 28:1194).
  const double mean = numberOf(folder_ / "surface", "thickness_mean_nearest") / 1.07;
  std::printf("mean thickness %.3f mm\n", mean);
  EXPECT_GT(mean, 2.3);
  EXPECT_LT(mean, 2.9);
}

/// Which numbers of a head were implausible.
std::set<std::string> flagsOf(const fs::path& folder) {
  std::set<std::string> names;
  const auto summary = readJson(folder / "summary.json");
  for (const auto& flag : summary["flags"]) names.insert(flag["name"].get<std::string>());
  return names;
}

/// The template's brain, or its head, on voxels of 2 mm, changed: for tests of the way, not of the
/// tissues.
template <class Change>
void writeCoarse(const fs::path& file, const Change& change, const char* name = "ch2bet.nii.gz") {
  const Volume<float> brain = io::readScalars(kTemplates / name).volume;
  Grid grid = brain.grid;
  for (int a = 0; a < 3; ++a) grid.size[a] /= 2;
  grid.spacing *= 2;
  grid.origin = brain.grid.toWorld(Vector::Constant(0.5));
  Volume<float> image(grid, 0.0f);
  for (std::size_t v = 0; v < image.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const auto from = change(grid, std::array{i, j, k});
    if (!from) continue;
    const auto [a, b, c] = *from;
    for (int n = 0; n < 8; ++n) {
      image[v] += brain(2 * a + (n & 1), 2 * b + (n >> 1 & 1), 2 * c + (n >> 2)) / 8;
    }
  }
  fs::create_directories(file.parent_path());
  io::writeVolume(file, image);
}

using Subscripts = std::array<int, 3>;
using Source = std::optional<Subscripts>;

Source asItIs(const Grid& /*grid*/, const Subscripts& at) {
  return at;
}

Source leftHalf(const Grid& grid, const Subscripts& at) {
  return grid.toWorld(Vector(at[0], at[1], at[2])).x() < 0 ? Source(at) : std::nullopt;
}

Source upperHalf(const Grid& grid, const Subscripts& at) {
  return grid.toWorld(Vector(at[0], at[1], at[2])).z() > 18 ? Source(at) : std::nullopt;
}

Source flipped(const Grid& grid, const Subscripts& at) {
  return Subscripts{grid.size[0] - 1 - at[0], at[1], at[2]};
}

Source upsideDown(const Grid& grid, const Subscripts& at) {
  return Subscripts{at[0], at[1], grid.size[2] - 1 - at[2]};
}

TEST_F(WholeHead, HalvesOfAHeadAreFlagged) {
  const fs::path image = folder_ / "half.nii.gz";
  for (const auto& half : {leftHalf, upperHalf}) {
    writeCoarse(image, half, "ch2.nii.gz");
    const auto run = patiently({"segment", image, "--force", "--out", folder_ / "segment"});
    EXPECT_EQ(run.exitCode, 3) << run;
    const auto flags = flagsOf(folder_ / "segment");
    EXPECT_TRUE(flags.contains("registration")) << run;
    EXPECT_EQ(flags.contains("half-head"), half == leftHalf) << run;
    if (half != leftHalf) continue;
    std::vector<std::string> words = {"segment",
                                      image,
                                      "--template-transform",
                                      folder_ / "segment/to_template.h5",
                                      "--out",
                                      folder_ / "accepted",
                                      "--force"};
    for (const std::string& flag : flags) words.insert(words.end(), {"--accept", flag});
    const auto accepted = patiently(words);
    EXPECT_EQ(accepted.exitCode, 0) << accepted;
  }
}

TEST_F(WholeHead, UpsideDownIsFlaggedByItsRegistrationAlone) {
  const fs::path image = folder_ / "t1.nii.gz";
  writeCoarse(image, upsideDown);
  const auto run = patiently({"segment", image, "--out", folder_ / "segment"});
  EXPECT_EQ(run.exitCode, 3) << run;
  EXPECT_EQ(flagsOf(folder_ / "segment"), std::set<std::string>{"registration"});
  const auto flag = readJson(folder_ / "segment/summary.json")["flags"][0];
  EXPECT_EQ(flag["value"], numberOf(folder_ / "segment", "registration_correlation"));
}

TEST_F(WholeHead, AHeadThatLiesOnItsSideIsFound) {
  const fs::path image = folder_ / "side.nii.gz";
  writeCoarse(image, asItIs, "ch2.nii.gz");
  Volume<float> head = io::readScalars(image).volume;
  const Eigen::AngleAxisd turn(80 * kPi / 180, Vector(1, 2, -2).normalized());
  head.grid.direction = turn * head.grid.direction;
  head.grid.origin = turn * head.grid.origin;
  io::writeVolume(image, head);
  const auto run = patiently({"segment", image, "--out", folder_ / "segment"});
  EXPECT_EQ(run.exitCode, 0) << run;
  EXPECT_GT(numberOf(folder_ / "segment", "registration_correlation"), 0.95);
  EXPECT_NEAR(numberOf(folder_ / "segment", "registration_turn"), 80, 1);
  EXPECT_EQ(readJson(folder_ / "segment/summary.json")["verdict"], "look");
}

TEST_F(WholeHead, AProtonDensityImageIsRefusedByItsFluid) {
  const fs::path image = folder_ / "pd.nii.gz";
  writeCoarse(image, asItIs);
  Volume<float> brain = io::readScalars(image).volume;
  for (float& value : brain.data) value = value > 0 ? 130 - 0.25f * value : 0;
  io::writeVolume(image, brain);
  const auto run =
      patiently({"segment", image, "--accept", "bright-fluid", "--out", folder_ / "segment"});
  EXPECT_EQ(run.exitCode, 2) << run;
  EXPECT_NE(run.err.find("proton density"), std::string::npos) << run;
  EXPECT_NE(run.err.find("--accept fluid-of-white"), std::string::npos) << run;
  EXPECT_FALSE(fs::exists(folder_ / "segment")) << run;
}

/// A study of the template's brain, its left half and its mirror image, once for all tests.
class CoarseHeads : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (!fs::exists(kTemplates)) return;
    folder_ = new TemporaryFolder;
    writeCoarse(image("half"), leftHalf);
    writeCoarse(image("whole"), asItIs);
    // Nothing tells a flip, and nothing tries to: it is done like the others.
    writeCoarse(image("flipped"), flipped);
    writeText(*folder_ / "data/dataset_description.json",
              R"({"Name": "a", "BIDSVersion": "1.8.0"})");
    study_ = new CommandResult(patiently(study("out") + kSmall));
  }
  static void TearDownTestSuite() {
    delete study_;
    delete folder_;
  }
  void SetUp() override {
    if (!fs::exists(kTemplates)) GTEST_SKIP() << "skipped: no templates of mricron-data";
  }

  static std::string image(const std::string& subject) {
    return *folder_ / ("data/sub-" + subject + "/anat/sub-" + subject + "_T1w.nii.gz");
  }
  static std::vector<std::string> study(const std::string& out) {
    return {"bids", *folder_ / "data", *folder_ / out, "participant", "--hemisphere", "L"};
  }
  static fs::path segmentOf(const std::string& subject, const std::string& out = "out") {
    return *folder_ / (out + "/runs/sub-" + subject + "_hemi-L/segment");
  }

  static inline const std::vector<std::string> kSmall = {"--steps", "segment,surface",
                                                         "--surface.faces", "5000"};
  static inline TemporaryFolder* folder_ = nullptr;
  static inline CommandResult* study_ = nullptr;
};

TEST_F(CoarseHeads, ARegistrationIsTakenAgainAndJudgedAnew) {
  const fs::path first = segmentOf("whole");
  const std::string made = first / "to_template.h5";
  const auto segmentation = [&](const fs::path& place) {
    std::array<std::string, 3> content;
    for (int n = 0; n < 3; ++n) {
      static constexpr std::array kNames = {"seg.nii.gz", "hemisphere.nii.gz", "atlas.nii.gz"};
      content[n] = readText(place / kNames[n]);
    }
    return content;
  };
  const fs::path taken = *folder_ / "again/segment";
  const auto again =
      patiently({"run", image("whole"), "--segment.template-transform", made, "--hemisphere", "L",
                 "--steps", "segment", "--out", *folder_ / "again"});
  ASSERT_EQ(again.exitCode, 0) << again;
  EXPECT_EQ(segmentation(taken), segmentation(first));
  for (const char* number : {"registration_correlation", "registration_stretch"}) {
    EXPECT_NEAR(numberOf(taken, number), numberOf(first, number), 1e-4);
  }
  EXPECT_FALSE(readJson(taken / "summary.json").contains("registration_information"));

  // Of another image: the same head upside down.
  const std::string turned = *folder_ / "other.nii.gz";
  writeCoarse(turned, upsideDown);
  const auto other =
      patiently({"segment", turned, "--template-transform", made, "--out", *folder_ / "other"});
  EXPECT_EQ(other.exitCode, 3) << other;
  EXPECT_TRUE(flagsOf(*folder_ / "other").contains("registration")) << other;
  EXPECT_NE(other.err.find("the agreement with the template"), std::string::npos) << other;

  writeText(*folder_ / "nonsense.h5", "no transform at all\n");
  const auto refused = patiently({"segment", image("whole"), "--template-transform",
                                  *folder_ / "nonsense.h5", "--out", *folder_ / "refused"});
  EXPECT_EQ(refused.exitCode, 2) << refused;
  EXPECT_NE(refused.err.find("nonsense.h5"), std::string::npos) << refused;
  const auto none = explica({"segment", image("whole"), "--template-transform", made, "--template",
                             "none", "--out", *folder_ / "none"});
  EXPECT_EQ(none.exitCode, 1) << none;
}

TEST_F(CoarseHeads, AStudyTakesTheRegistrationsOfAnEarlierOne) {
  const auto second = patiently(
      study("second") + std::vector<std::string>{"--participant-label", "whole", "--steps",
                                                 "segment", "--registrations", *folder_ / "out"});
  ASSERT_EQ(second.exitCode, 0) << second;
  const fs::path taken = segmentOf("whole", "second");
  EXPECT_FALSE(readJson(taken / "summary.json").contains("registration_information"));
  EXPECT_EQ(readText(taken / "seg.nii.gz"), readText(segmentOf("whole") / "seg.nii.gz"));
}

TEST_F(CoarseHeads, HalfABrainIsFlaggedByARunAndFailsItsRowOfAStudyAlone) {
  const auto run = patiently(
      std::vector<std::string>{"run", image("half"), "--segment.template-transform",
                               segmentOf("half") / "to_template.h5", "--out", *folder_ / "run"} +
      kSmall);
  EXPECT_EQ(run.exitCode, 3) << run;
  EXPECT_TRUE(flagsOf(*folder_ / "run").contains("stretch")) << run;
  EXPECT_GT(numberOf(segmentOf("half"), "registration_stretch"), 1.5);
  EXPECT_EQ(study_->exitCode, 3) << *study_;
  const auto flags = readJson(*folder_ / "out/summary.json")["flags"];
  ASSERT_FALSE(flags.empty());
  for (const auto& flag : flags) EXPECT_EQ(flag["run"], "sub-half_hemi-L");
  ASSERT_EQ(explica({"bids", *folder_ / "data", *folder_ / "out", "group"}).exitCode, 0);
  const std::string table = readText(*folder_ / "out/study.tsv");
  EXPECT_NE(table.find("sub-half\tL\timplausible (segment): "), std::string::npos) << table;
  for (const char* subject : {"whole", "flipped"}) {
    EXPECT_NE(table.find("sub-" + std::string(subject) + "\tL\tdone\t"), std::string::npos)
        << table;
  }
}

/// The template's T1 as another animal's: turned by 10 degrees, moved, bent by 1.5 mm, shaded and
/// with noise, on voxels of 0.6 mm.
Volume<float> anotherMacaque() {
  const Volume<float> brain = io::readScalars(kTemplates / "inia19-t1-brain.nii.gz",
                                              {.placement = io::PlacementChoice::Sform})
                                  .volume;
  Grid grid;
  grid.spacing = Vector::Constant(0.6);
  grid.size = {150, 180, 120};
  grid.origin = Point(-41.7, -55.7, -30.7);
  Volume<float> image(grid, 0.0f);
  std::mt19937 generator(1);
  std::normal_distribution<double> noise(0, 3);
  const Eigen::AngleAxisd turn(kPi / 18, Vector::UnitZ());
  for (std::size_t v = 0; v < image.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    const Point at = grid.toWorld(Vector(i, j, k));
    Point from = turn * Point(at - Point(3, -2, 5)) + Point(0, -6, 2);
    from += 1.5 * Vector(std::sin(from.y() / 12), std::cos(from.z() / 11), std::sin(from.x() / 13));
    const double sum = valueAt(brain, from);
    if (sum < 25) continue;
    image[v] = static_cast<float>(
        std::max(1.0, sum * (1 + 0.15 * std::sin(at.y() / 30)) + noise(generator)));
  }
  return image;
}

TEST_F(WholeHead, OfAMacaqueTakesItsOwnTemplate) {
  io::writeVolume(folder_ / "t1.nii.gz", anotherMacaque());
  const auto run =
      patiently({"run", folder_ / "t1.nii.gz", "--segment.template", "inia19", "--steps",
                 "segment,surface", "--surface.faces", "30000", "--out", folder_ / "run"});
  ASSERT_EQ(run.exitCode, 0) << run;
  EXPECT_NE(run.err.find("the sform is taken"), std::string::npos) << run;
  EXPECT_GT(numberOf(folder_ / "run/segment", "registration_correlation"), 0.9);
  EXPECT_NEAR(numberOf(folder_ / "run/segment", "brain_volume_ml"), 108, 5);
  const double left = numberOf(folder_ / "run/surface-L", "thickness_mean");
  const double right = numberOf(folder_ / "run/surface-R", "thickness_mean");
  std::printf("macaque: %.2f mm left, %.2f mm right\n", left, right);
  EXPECT_NEAR(left, right, 0.1);
  EXPECT_GT(left, 1.4);  // macaques: 1.5 to 2.5 mm
  EXPECT_LT(left, 2.6);
}

TEST_F(WholeHead, ALesionIsNotDrowned) {
  const fs::path file = folder_ / "t1.nii.gz";
  writeCoarse(file, asItIs);
  Volume<float> image = io::readScalars(file).volume;
  const Point middle(-26, -22, 30);  // of the left hemisphere's white matter
  std::vector<std::size_t> lesion;
  for (std::size_t v = 0; v < image.size(); ++v) {
    const auto [i, j, k] = image.grid.subscripts(v);
    if ((image.grid.toWorld(Vector(i, j, k)) - middle).norm() > 12 || image[v] == 0) continue;
    image[v] = 32 + static_cast<float>(v % 5);  // as bright as fluid
    lesion.push_back(v);
  }
  io::writeVolume(file, image);
  const auto run = patiently({"segment", file, "--out", folder_ / "segment"});
  ASSERT_EQ(run.exitCode, 0) << run;  // no reason to fail a study's row
  const auto found = io::readLabels(folder_ / "segment/seg.nii.gz").volume;
  double fluid = 0;
  for (const std::size_t v : lesion) fluid += found[v] == 1;
  EXPECT_GT(fluid, 0.9 * static_cast<double>(lesion.size()));
  // It is reported, too, and where it is: of its voxels those deep in the template's white matter.
  EXPECT_NE(run.err.find("deep white matter in the template"), std::string::npos) << run;
  const auto summary = readJson(folder_ / "segment/summary.json");
  EXPECT_GT(8 * summary["white_unlike_template"].get<double>(), 3000);  // mm3
  EXPECT_GT(summary["template_white_not_white_radius"].get<double>(), 5);
  const auto at = summary["template_white_not_white_at"].get<std::array<double, 3>>();
  EXPECT_LT((Point(at[0], at[1], at[2]) - middle).norm(), 8);
}

TEST_F(WholeHead, IsTakenOutOfItsSkullInAStudyAsTheScannerGivesIt) {
  fs::create_directories(folder_ / "data/sub-01/anat");
  fs::copy_file(kTemplates / "ch2.nii.gz", folder_ / "data/sub-01/anat/sub-01_T1w.nii.gz");
  writeText(folder_ / "data/dataset_description.json", R"({"Name": "a", "BIDSVersion": "1.8.0"})");
  Volume<float> ct = io::readScalars(kTemplates / "ch2.nii.gz").volume;
  for (float& value : ct.data) value = value < 10 ? -1000 : value;
  fs::create_directories(folder_ / "data/sub-02/anat");
  io::writeVolume(folder_ / "data/sub-02/anat/sub-02_T1w.nii.gz", ct);
  const auto run =
      patiently({"bids", folder_ / "data", folder_ / "out", "participant", "--hemisphere", "L",
                 "--steps", "segment,surface", "--surface.faces", "20000"});
  ASSERT_EQ(run.exitCode, 3) << run;  // the second is no T1: its row says so, the first is done
  EXPECT_TRUE(fs::exists(folder_ / "out/sub-01/anat/sub-01_hemi-L_pial.surf.gii"));
  const fs::path segment = folder_ / "out/runs/sub-01_hemi-L/segment";
  expectTheBrainOfColin27(segment);
  ASSERT_EQ(explica({"report", segment.string()}).exitCode, 0);
  EXPECT_NE(readText(segment / "report.html").find("Template on"), std::string::npos);
  ASSERT_EQ(explica({"bids", folder_ / "data", folder_ / "out", "group"}).exitCode, 0);
  const std::string table = readText(folder_ / "out/study.tsv");
  EXPECT_NE(table.find("sub-01\tL\tdone\t"), std::string::npos) << table;
  EXPECT_NE(table.find("sub-02\tL\tfailed: "), std::string::npos) << table;
}

}  // namespace
}  // namespace explica::testing
