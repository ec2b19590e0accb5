// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// explica thickness: what users type and what they get.

#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <numeric>
#include <sstream>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

/// A labelled volume of `size` voxels about the origin.
void writeLabels(const std::string& path, const std::array<int, 3>& size, const Vector& spacing,
                 const std::function<Label(const Point&, int slice)>& label) {
  Grid grid;
  grid.size = size;
  grid.spacing = spacing;
  grid.origin = -0.5 * Vector(size[0] - 1, size[1] - 1, size[2] - 1).cwiseProduct(spacing);
  Volume<Label> labels(grid);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto s = grid.subscripts(v);
    labels[v] = label(grid.toWorld(Vector(s[0], s[1], s[2])), s[2]);
  }
  io::writeVolume(path, labels);
}

/// Inside 1 up to 9 mm, tissue 2 up to 15 mm, outside 0.
Label shellAt(const Point& x) {
  const double r = x.norm();
  return r < 9 ? 1 : r < 15 ? 2 : 0;
}

void writeShell(const std::string& path) {
  writeLabels(path, {36, 36, 36}, Vector::Ones(), [](const Point& x, int) { return shellAt(x); });
}

/// Six slices, 8 mm apart, of a tube with a 6 mm wall.
Label tubeAt(const Point& x) {
  const double r = std::hypot(x[0], x[1]);
  return r < 9 ? 1 : r < 15 ? 2 : 0;
}

std::vector<std::string> thickness(const TemporaryFolder& folder, const std::string& labels,
                                   const std::vector<std::string>& more) {
  std::vector<std::string> words = {"thickness", folder / labels, "--inner", "1", "--tissue", "2"};
  words.insert(words.end(), more.begin(), more.end());
  words.insert(words.end(), {"--out", folder / "out", "--force"});
  return words;
}

Volume<float> map(const TemporaryFolder& folder, const std::string& name) {
  return io::readScalars(folder / (name + ".nii.gz")).volume;
}

struct Choice {
  const char* boundary;
  const char* method;
  double error;  ///< of the mean thickness, mm; the spacing is 1 mm
};
void PrintTo(const Choice& choice, std::ostream* stream) {
  *stream << choice.boundary << ' ' << choice.method;
}

class ThicknessOfShell : public ::testing::TestWithParam<Choice> {};

TEST_P(ThicknessOfShell, IsKnownAndFieldsAgree) {
  TemporaryFolder folder;
  writeShell(folder / "shell.nii.gz");
  const auto made = explica(thickness(
      folder, "shell.nii.gz", {"--boundary", GetParam().boundary, "--method", GetParam().method}));
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_NEAR(summary["thickness_mean"].get<double>(), 6, GetParam().error);
  EXPECT_EQ(summary["voxels_without_thickness"], 0);
  EXPECT_EQ(summary["termination"], "converged");
  for (const char* key : {"seconds_harmonic", "seconds_correspondence", "traced_fraction",
                          "residual", "thickness_median", "thickness_p05", "thickness_p95"}) {
    EXPECT_TRUE(summary.contains(key)) << key;
  }
  const auto labels = io::readLabels(folder / "shell.nii.gz").volume;
  const auto total = map(folder, "out/thickness"), inner = map(folder, "out/inner_distance"),
             outer = map(folder, "out/outer_distance"), depth = map(folder, "out/depth"),
             u = map(folder, "out/harmonic");
  const auto layers = io::readLabels(folder / "out/layers.nii.gz").volume;
  const auto innerPoint = io::readVectors(folder / "out/inner_point.nii.gz").volume;
  for (std::size_t v = 0; v < labels.size(); ++v) {
    if (labels[v] != 2) {
      ASSERT_EQ(total[v], 0);
      ASSERT_EQ(u[v], labels[v] == 1 ? 0 : 1);
      continue;
    }
    ASSERT_NEAR(inner[v] + outer[v], total[v], 1e-5);
    ASSERT_NEAR(inner[v] / total[v], depth[v], 1e-6);
    ASSERT_EQ(layers[v], std::min(3, static_cast<int>(3 * depth[v]) + 1));
    ASSERT_TRUE(u[v] >= 0 && u[v] <= 1);
    ASSERT_NEAR(innerPoint[v].norm(), 9, 1.2);
  }
}

INSTANTIATE_TEST_SUITE_P(Table, ThicknessOfShell,
                         ::testing::Values(Choice{"subvoxel", "hybrid", 0.1},
                                           Choice{"subvoxel", "lagrangian", 0.1},
                                           Choice{"subvoxel", "eulerian", 1.2},
                                           Choice{"staircase", "hybrid", 1.2},
                                           Choice{"staircase", "lagrangian", 1.2},
                                           Choice{"staircase", "eulerian", 1.2}));

TEST(ThicknessCommand, AppendixAIsDialledByLambda) {
  const TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "eccentric", "--size", "64", "--out", folder / "e"}).exitCode, 0);
  double before = 2;
  for (const std::string lambda : {"0", "0.3", "1", "inf"}) {
    const auto run = explica({"thickness", "--inner-level", folder / "e/inner_level.nii.gz",
                              "--outer-level", folder / "e/outer_level.nii.gz", "--method",
                              "appendix-a", "--lambda", lambda, "--out", folder / lambda});
    ASSERT_EQ(run.exitCode, 0) << run;
    const double traced = readJson(folder / (lambda + "/summary.json"))["traced_fraction"];
    EXPECT_LT(traced, before) << lambda;
    before = traced;
  }
}

TEST(ThicknessCommand, LambdaZeroIsTheLagrangianMethod) {
  TemporaryFolder folder;
  writeShell(folder / "shell.nii.gz");
  ASSERT_EQ(explica(thickness(folder, "shell.nii.gz", {"--lambda", "0"})).exitCode, 0);
  const auto hybrid = stableHashes(folder.path() / "out");
  ASSERT_EQ(explica(thickness(folder, "shell.nii.gz", {"--method", "lagrangian"})).exitCode, 0);
  const auto lagrangian = stableHashes(folder.path() / "out");
  for (const char* name : {"thickness.nii.gz", "inner_point.nii.gz", "outer_point.nii.gz"}) {
    EXPECT_EQ(hybrid.at(name), lagrangian.at(name)) << name;
  }
  EXPECT_EQ(explica(thickness(folder, "shell.nii.gz", {"--lambda", "-1"})).exitCode, 1);
}

TEST(ThicknessCommand, LambdaByItselfMeansTheHybrid) {
  TemporaryFolder folder;
  writeShell(folder / "shell.nii.gz");
  const auto hashesWith = [&](const std::vector<std::string>& words) {
    EXPECT_EQ(explica(thickness(folder, "shell.nii.gz", words)).exitCode, 0);
    return stableHashes(folder.path() / "out").at("thickness.nii.gz");
  };
  const auto followed = hashesWith({});
  const auto dialled = hashesWith({"--lambda", "5"});
  EXPECT_LT(double(readJson(folder / "out/summary.json")["traced_fraction"]), 0.9);
  EXPECT_NE(dialled, followed);
  EXPECT_EQ(dialled, hashesWith({"--method", "hybrid", "--lambda", "5"}));
}

TEST(ThicknessCommand, LevelSetsGiveTheExactThicknessOfSpheroids) {
  TemporaryFolder folder;
  ASSERT_EQ(
      explica({"phantom", "spheroid", "--size", "64", "--spacing", "2", "--out", folder / "p"})
          .exitCode,
      0);
  const auto made =
      explica({"thickness", "--inner-level", folder / "p/inner_level.nii.gz", "--outer-level",
               folder / "p/outer_level.nii.gz", "--out", folder / "out"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto ours = map(folder, "out/thickness"), exact = map(folder, "p/thickness");
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t v = 0; v < ours.size(); ++v) {
    if (ours[v] == 0) continue;
    sum += std::abs(ours[v] - exact[v]) / 2;  // voxels
    ++count;
  }
  EXPECT_GT(count, 10000U);
  EXPECT_LT(sum / static_cast<double>(count), 0.02);
}

TEST(ThicknessCommand, ProbabilityMapsCrossAtTheirLevel) {
  TemporaryFolder folder;
  Grid grid;
  grid.size = {36, 36, 36};
  grid.origin = Vector::Constant(-17.5);
  const auto write = [&](const char* name, double radius) {
    Volume<float> map(grid);
    for (std::size_t v = 0; v < map.size(); ++v) {
      const auto s = grid.subscripts(v);
      const double r = grid.toWorld(Vector(s[0], s[1], s[2])).norm();
      map[v] = static_cast<float>(std::clamp(0.5 + 0.25 * (radius - r), 0.0, 1.0));
    }
    io::writeVolume(folder / name, map);
  };
  write("in.nii.gz", 9.3);
  write("out.nii.gz", 14.1);
  const auto made = explica({"thickness", "--inner-level", folder / "in.nii.gz", "--outer-level",
                             folder / "out.nii.gz", "--level", "0.5", "--out", folder / "out"});
  ASSERT_EQ(made.exitCode, 0) << made;
  EXPECT_NEAR(readJson(folder / "out/summary.json")["thickness_mean"].get<double>(), 4.8, 0.02);
}

TEST(ThicknessCommand, LayersOfEqualVolumeHoldEquallyManyVoxels) {
  TemporaryFolder folder;
  writeShell(folder / "shell.nii.gz");
  const auto counts = [&](const char* kind) {
    EXPECT_EQ(explica(thickness(folder, "shell.nii.gz", {"--layers", "2", "--layer-kind", kind}))
                  .exitCode,
              0);
    const auto layers = io::readLabels(folder / "out/layers.nii.gz").volume;
    std::array<double, 3> count{};
    for (const Label layer : layers.data) ++count.at(static_cast<std::size_t>(layer));
    return count[2] / count[1];
  };
  EXPECT_NEAR(counts("volume"), 1, 0.08);
  // Half way, at 12 mm: (15^3 - 12^3) / (12^3 - 9^3).
  EXPECT_NEAR(counts("depth"), 1647.0 / 999, 0.15);
}

TEST(ThicknessCommand, GridFollowsTheTissueInTwoAndThreeDimensions) {
  TemporaryFolder folder;
  writeShell(folder / "shell.nii.gz");
  ASSERT_EQ(explica(thickness(folder, "shell.nii.gz", {"--cells", "4"})).exitCode, 0);
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_GT(summary["grid_trajectories"], 1000);
  EXPECT_EQ(summary["grid_cells"].get<int>() % 4, 0);
  EXPECT_NE(readText(folder / "out/grid.vtu").find("thickness"), std::string::npos);
  writeLabels(folder / "ring.nii.gz", {36, 36, 1}, Vector::Ones(),
              [](const Point& x, int) { return tubeAt(x); });
  ASSERT_EQ(explica(thickness(folder, "ring.nii.gz", {"--cells", "4"})).exitCode, 0);
  EXPECT_GT(readJson(folder / "out/summary.json")["grid_cells"], 100);
  EXPECT_EQ(explica(thickness(folder, "ring.nii.gz", {"--cells", "0"})).exitCode, 1);
}

TEST(ThicknessCommand, SulciAreRecoveredByDefaultButNotInHearts) {
  TemporaryFolder folder;
  // Two balls of white matter whose grey shells touch: the sheet between them is hidden.
  writeLabels(folder / "sulcus.nii.gz", {48, 30, 30}, Vector::Ones(), [](const Point& x, int) {
    const double r = std::min((x - Point(-9, 0, 0)).norm(), (x - Point(9, 0, 0)).norm());
    return r < 6 ? 1 : r < 11 ? 2 : 0;
  });
  const auto recovered = [&](const std::vector<std::string>& words) {
    const auto made = explica(thickness(folder, "sulcus.nii.gz", words));
    EXPECT_EQ(made.exitCode, 0) << made;
    return readJson(folder / "out/summary.json")["sulcal_voxels_recovered"].get<int>();
  };
  EXPECT_GT(recovered({}), 50);
  EXPECT_TRUE(fs::exists(folder / "out/sulci.nii.gz"));
  EXPECT_EQ(recovered({"--sulci", "ignore"}), 0);
  EXPECT_FALSE(fs::exists(folder / "out/sulci.nii.gz"));
  EXPECT_EQ(recovered({"--per-slice"}), 0);
  EXPECT_EQ(recovered({"--open-ends"}), 0);
  EXPECT_GT(recovered({"--per-slice", "--sulci", "recover"}), 50);
}

TEST(ThicknessCommand, ASliceOfCortexGivesItsGridLayersAndSulci) {
  TemporaryFolder folder;
  // A comb of white matter whose slots grey matter fills.
  writeLabels(folder / "slice.nii.gz", {130, 50, 1}, Vector(0.5, 0.5, 2), [](const Point& p, int) {
    const Point x = 2 * p;
    if (std::abs(x[0]) > 58 || x[1] < -20 || x[1] > 13) return 0;
    return x[1] > 10 || (std::abs(std::remainder(x[0], 12.0)) < 3 && x[1] > -14) ? 2 : 1;
  });
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--cells", "2"},
        std::vector<std::string>{"--cells", "2", "--per-slice"}}) {
    const auto made = explica(thickness(folder, "slice.nii.gz", words));
    ASSERT_EQ(made.exitCode, 0) << made;
    const auto summary = readJson(folder / "out/summary.json");
    EXPECT_EQ(summary["sulci"], "recover");
    EXPECT_GT(summary["sulcal_voxels_recovered"].get<int>(), 200);
    EXPECT_NEAR(summary["thickness_median"].get<double>(), 1.5, 0.15);
    EXPECT_TRUE(fs::exists(folder / "out/grid.vtu"));
    const auto layers = io::readLabels(folder / "out/layers.nii.gz").volume;
    EXPECT_EQ(*std::max_element(layers.data.begin(), layers.data.end()), 3);
  }
}

TEST(ThicknessCommand, GreyMatterBeyondANeckIsCountedAndHarmsNothingElse) {
  TemporaryFolder folder;
  // A shell of 4 mm, and a ball of grey matter joined to it by a neck of two voxels: what flows
  // into the ball leaves it on all sides, so that u is 1 there in nearly all its digits.
  const auto labelAt = [](const Point& p) -> Label {
    const Point x = p + Point(12, 0, 0);
    const bool neck = x[0] > 0 && x[0] < 30 && std::abs(x[1]) < 1 && std::abs(x[2]) < 1;
    if (x.norm() < 10) return 1;
    return x.norm() < 14 || neck || (x - Point(30, 0, 0)).norm() < 8 ? 2 : 0;
  };
  writeLabels(folder / "neck.nii.gz", {64, 40, 40}, Vector::Ones(),
              [&](const Point& x, int) { return labelAt(x); });
  const auto made = explica(thickness(folder, "neck.nii.gz", {}));
  EXPECT_EQ(made.exitCode, 3) << made;
  EXPECT_NE(made.err.find("whose trajectory ends before a boundary"), std::string::npos) << made;
  const auto found = io::readScalars(folder / "out/thickness.nii.gz").volume;
  const auto labels = io::readLabels(folder / "neck.nii.gz").volume;
  std::size_t without = 0;
  for (std::size_t v = 0; v < found.size(); ++v) {
    if (labels[v] != 2) continue;
    const auto at = found.grid.subscripts(v);
    const Point x = found.grid.toWorld(Vector(at[0], at[1], at[2])) + Point(12, 0, 0);
    without += found[v] == 0;
    if (x[0] < 12) {
      EXPECT_NEAR(found[v], 4, 0.75) << x.transpose();
    }
  }
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["voxels_without_thickness"].get<std::size_t>(), without);
  EXPECT_NEAR(static_cast<double>(without), 2174, 60);
  EXPECT_NEAR(summary["thickness_mean_columns"].get<double>(), 4, 0.05);
}

TEST(ThicknessCommand, NoFluxCrossesAnInsulatedCut) {
  TemporaryFolder folder;
  writeLabels(folder / "half.nii.gz", {36, 36, 36}, Vector::Ones(),
              [](const Point& x, int) { return x[2] > 4 ? 5 : shellAt(x); });
  const auto made = explica(thickness(folder, "half.nii.gz", {"--insulated", "5"}));
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_NEAR(summary["thickness_mean"].get<double>(), 6, 0.15);
  EXPECT_NEAR(summary["thickness_p95"].get<double>(), 6, 0.5);
}

TEST(ThicknessCommand, AnOpenRingIsAWarningThatNamesItsSlice) {
  TemporaryFolder folder;
  writeLabels(folder / "tube.nii.gz", {36, 36, 6}, Vector(1, 1, 8), [](const Point& x, int k) {
    const Label label = tubeAt(x);
    return k == 4 && label == 2 && std::abs(x[0]) < 2 && x[1] > 0 ? 0 : label;
  });
  const auto made = explica(thickness(folder, "tube.nii.gz", {"--per-slice"}));
  ASSERT_EQ(made.exitCode, 0) << made;
  EXPECT_NE(made.err.find("the ring is open in slice 4"), std::string::npos) << made;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_GT(summary["direct_contacts"], 0);
  EXPECT_NEAR(summary["thickness_median"].get<double>(), 6, 0.2);
}

TEST(ThicknessCommand, VentriclePhantomIsExactAwayFromItsBase) {
  TemporaryFolder folder;
  ASSERT_EQ(
      explica({"phantom", "ventricle", "--size", "116", "--spacing", "1", "--out", folder / "p"})
          .exitCode,
      0);
  const auto made =
      explica({"thickness", folder / "p/labels.nii.gz", "--insulated", "4", "--inner-level",
               folder / "p/inner_level.nii.gz", "--outer-level", folder / "p/outer_level.nii.gz",
               "--level-inside", "below", "--sulci", "ignore", "--out", folder / "out"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto ours = map(folder, "out/thickness"), exact = map(folder, "p/thickness");
  std::size_t seen = 0;
  for (std::size_t v = 0; v < ours.size(); ++v) {
    const auto s = ours.grid.subscripts(v);
    if (ours[v] == 0 || ours.grid.toWorld(Vector(s[0], s[1], s[2]))[2] > 3) continue;
    ++seen;
    ASSERT_NEAR(ours[v], exact[v], 0.1);
  }
  EXPECT_GT(seen, 10000U);
}

TEST(ThicknessCommand, ARealShortAxisStackGivesItsWallThoughOneRingIsOpen) {
  const fs::path labels = fs::path(EXPLICA_REAL_DATA) / "lv_sunnybrook_SCD0000101/ED_label.nii.gz";
  if (!fs::exists(labels)) GTEST_SKIP() << "skipped: no real data";
  TemporaryFolder folder;
  const auto made = explica({"thickness", labels.string(), "--inner", "1", "--tissue", "2",
                             "--per-slice", "--out", folder / "out"});
  ASSERT_EQ(made.exitCode, 0) << made;
  EXPECT_NE(made.err.find("open in slice 0"), std::string::npos) << made;
  EXPECT_NEAR(readJson(folder / "out/summary.json")["thickness_mean"].get<double>(), 7, 1);
}

struct BadTissue {
  const char* name;
  std::vector<std::string> words;
  std::string said;
  std::function<Label(const Point&, int)> label = [](const Point& x, int) { return shellAt(x); };
};
void PrintTo(const BadTissue& bad, std::ostream* stream) {
  *stream << bad.name;
}

class BadTissueInput : public ::testing::TestWithParam<BadTissue> {};

TEST_P(BadTissueInput, IsRefusedInOneSentence) {
  TemporaryFolder folder;
  const BadTissue& bad = GetParam();
  writeLabels(folder / "bad.nii.gz", {36, 36, 36}, Vector::Ones(), bad.label);
  std::vector<std::string> words = {"thickness", folder / "bad.nii.gz", "--out", folder / "out"};
  words.insert(words.end(), bad.words.begin(), bad.words.end());
  const auto made = explica(words);
  EXPECT_EQ(made.exitCode, 2) << made;
  EXPECT_NE(made.err.find(bad.said), std::string::npos) << made;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

const std::vector<std::string> kUsual = {"--inner", "1", "--tissue", "2"};

INSTANTIATE_TEST_SUITE_P(
    Table, BadTissueInput,
    ::testing::Values(
        BadTissue{"OneSide", kUsual, "the tissue touches only the inner region",
                  [](const Point& x, int) { return x.norm() < 9 ? 1 : 2; }},
        BadTissue{"NoPieceTouchesBoth",
                  {"--inner", "1", "--tissue", "2", "--outer", "0"},
                  "no connected piece of tissue touches both",
                  [](const Point& x, int) {
                    const double r = x.norm();
                    return r < 5 ? 1 : r < 7 ? 2 : r < 11 ? 5 : r < 15 ? 2 : 0;
                  }},
        BadTissue{"LabelAbsent",
                  {"--inner", "1", "--tissue", "7,9"},
                  "label 7, 9 is absent; the file has 0, 1, 2"},
        BadTissue{"TwoRoles", {"--inner", "1", "--tissue", "1"}, "label 1 is given two roles"},
        BadTissue{"NoTissueLabel", {"--inner", "1"}, "no tissue label was given (--tissue)"},
        BadTissue{"NoInnerLabel", {"--tissue", "2"}, "no inner label was given (--inner)"}),
    [](const auto& row) { return row.param.name; });

/// Trajectories of a block leave the image: grid faces that they meet there are in no memory.
TEST(ThicknessCommand, ABlockWhoseTrajectoriesLeaveTheImageIsMeasured) {
  const fs::path block = fs::path(EXPLICA_REAL_DATA) / "laynii_sc/sc_rim.nii.gz";
  if (!fs::exists(block)) GTEST_SKIP() << "skipped: no real data";
  TemporaryFolder folder;
  const auto made =
      explica({"thickness", block, "--inner", "2", "--tissue", "3", "--out", folder / "out"});
  EXPECT_EQ(made.exitCode, 0) << made;
}

TEST(ThicknessCommand, AHoleThroughTheTissueIsAWarningWithItsPlace) {
  TemporaryFolder folder;
  writeLabels(folder / "hole.nii.gz", {36, 36, 36}, Vector::Ones(), [](const Point& x, int) {
    return x[2] > 0 && std::hypot(x[0], x[1]) < 2 && shellAt(x) == 2 ? 0 : shellAt(x);
  });
  const auto made = explica(thickness(folder, "hole.nii.gz", {}));
  ASSERT_EQ(made.exitCode, 0) << made;
  EXPECT_NE(made.err.find("no tissue between the inner and the outer region"), std::string::npos)
      << made;
  EXPECT_GT(readJson(folder / "out/summary.json")["direct_contacts"], 0);
}

TEST(ThicknessCommand, AVoxelSizeOfZeroIsRefused) {
  TemporaryFolder folder;
  writeText(folder / "a.mha",
            "ObjectType = Image\nNDims = 3\nBinaryData = True\nElementSpacing = 1 0 1\n"
            "DimSize = 8 8 8\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" +
                std::string(512, '\1'));
  const auto made = explica(thickness(folder, "a.mha", {}));
  EXPECT_EQ(made.exitCode, 2) << made;
  EXPECT_NE(made.err.find("a.mha"), std::string::npos) << made;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(ThicknessCommand, LevelSetsComeInPairs) {
  TemporaryFolder folder;
  writeShell(folder / "shell.nii.gz");
  const auto made =
      explica({"thickness", "--inner-level", folder / "shell.nii.gz", "--out", folder / "out"});
  EXPECT_EQ(made.exitCode, 1) << made;
  EXPECT_NE(made.err.find("--outer-level"), std::string::npos) << made;
}

}  // namespace
}  // namespace explica::testing
