// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// What leads where thickness is told, and that no length inside counts in millimetres.

#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"
#include "Explica/Testing/Grids.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

/// A ball of white matter 3 out of the middle of a ball of grey matter 2, `unit` mm to a voxel: its
/// grey matter is 3 to 7 voxels thick.
Volume<Label> eccentricBalls(double unit) {
  constexpr int n = 44;
  Volume<Label> labels(cubeGrid(n, unit));
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto at = labels.grid.subscripts(v);
    const Vector p = Vector(at[0], at[1], at[2]) - Vector::Constant(0.5 * (n - 1));
    labels[v] = (p - Vector(2, 0, 0)).norm() < 12 ? 3 : p.norm() < 17 ? 2 : 0;
  }
  return labels;
}

TEST(Means, OfTheMiddleSurfaceLeadAndThatOfVoxelsIsNamed) {
  TemporaryFolder folder;
  io::writeVolume(folder / "seg.nii.gz", eccentricBalls(1));
  const fs::path run = fs::path(folder / "study/runs/sub-01_hemi-L");
  const auto made = explica(
      {"run", folder / "seg.nii.gz", "--kind", "labels", "--steps", "thickness,surface,report",
       "--thickness.inner", "3", "--thickness.tissue", "2", "--surface.white-label", "3",
       "--surface.grey-label", "2", "--surface.faces", "3000", "--out", run.string()});
  ASSERT_TRUE(made.exitCode == 0 || made.exitCode == 3) << made;

  const auto voxels = readJson(run / "thickness/summary.json");
  const double mean = voxels["thickness_mean"];
  EXPECT_EQ(voxels["thickness_mean_columns"], voxels["thickness_mean"]);
  EXPECT_NEAR(mean, readJson(run / "surface/summary.json")["thickness_mean"].get<double>(), 0.02);
  EXPECT_LT(mean, voxels["thickness_mean_voxels"].get<double>() - 0.1);
  const auto before = [](const std::string& text, const char* first, const char* second) {
    ASSERT_NE(text.find(first), std::string::npos) << first;
    ASSERT_NE(text.find(second), std::string::npos) << second;
    EXPECT_LT(text.find(first), text.find(second)) << first;
  };
  before(readText(run / "thickness/summary.json"), "thickness_mean", "thickness_mean_voxels");
  // Where there are surfaces their mean leads, else that of the volume; both say why voxels' is
  // greater.
  ASSERT_EQ(explica({"report", (run / "thickness").string()}).exitCode, 0);
  const std::string whole = readText(run / "report.html"),
                    alone = readText(run / "thickness/report.html");
  EXPECT_NE(whole.find("Mean thickness"), std::string::npos);
  EXPECT_EQ(whole.find("Mean thickness over voxels"), std::string::npos);
  for (const std::string* page : {&whole, &alone}) {
    EXPECT_NE(page->find("a thick column holds more voxels"), std::string::npos);
  }

  // A reader of the whole finds one histogram, by the definition that leads.
  EXPECT_NE(whole.find("share of vertices"), std::string::npos);
  EXPECT_EQ(whole.find("share of voxels"), std::string::npos);
  EXPECT_NE(alone.find("share of voxels"), std::string::npos);

  fs::create_directories(folder / "data");
  writeText(folder / "data/dataset_description.json", R"({"Name": "a", "BIDSVersion": "1.8.0"})");
  const auto group = explica({"bids", folder / "data", folder / "study", "group"});
  ASSERT_EQ(group.exitCode, 0) << group;
  const std::string table = readText(fs::path(folder / "study/study.tsv"));
  before(table, "surface.thickness_mean", "thickness.thickness_mean");
  EXPECT_EQ(table.find("thickness_mean_voxels"), std::string::npos);
  const std::string internals = readText(fs::path(folder / "study/study_internals.tsv"));
  EXPECT_NE(internals.find("thickness.thickness_mean_voxels"), std::string::npos);
}

TEST(Means, FreeSurfersDefinitionIsAnOptionAndAMap) {
  TemporaryFolder folder;
  io::writeVolume(folder / "seg.nii.gz", eccentricBalls(1));
  const auto made =
      explica({"surface", folder / "seg.nii.gz", "--white-label", "3", "--grey-label", "2",
               "--faces", "3000", "--thickness-measure", "nearest", "--out", folder / "out"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["thickness_measure"], "nearest");
  EXPECT_EQ(summary["thickness_mean"], summary["thickness_mean_nearest"]);
  // A trajectory is no shorter than the nearest distance.
  EXPECT_GE(summary["thickness_mean_trajectory"].get<double>(),
            summary["thickness_mean_nearest"].get<double>());
  const auto maps = io::readVertexMaps(folder / "out/thickness.shape.gii");
  ASSERT_EQ(maps.size(), 2U);
  EXPECT_EQ(maps[0].name, "thickness_nearest");
  EXPECT_EQ(maps[1].name, "thickness");
}

TEST(UnitOfLength, ChangesNeitherMemoryNorShape) {
  double surfaceMemory = 0, thicknessMemory = 0;
  for (const double unit : {1.0, 1.0 / 1024, 1024.0}) {
    TemporaryFolder folder;
    io::writeVolume(folder / "seg.nii.gz", eccentricBalls(unit));
    const auto surface =
        explica({"surface", folder / "seg.nii.gz", "--white-label", "3", "--grey-label", "2",
                 "--faces", "3000", "--accept", "thickness-mean", "--out", folder / "surface"});
    ASSERT_EQ(surface.exitCode, 0) << surface;
    const auto thickness = explica({"thickness", folder / "seg.nii.gz", "--inner", "3", "--tissue",
                                    "2", "--out", folder / "thickness"});
    ASSERT_EQ(thickness.exitCode, 0) << thickness;
    const auto ofSurface = readJson(folder / "surface/summary.json"),
               ofVoxels = readJson(folder / "thickness/summary.json");
    const double first = ofSurface["peak_memory_bytes"], second = ofVoxels["peak_memory_bytes"];
    if (surfaceMemory == 0) {
      surfaceMemory = first;
      thicknessMemory = second;
    }
    EXPECT_NEAR(first, surfaceMemory, 0.1 * surfaceMemory) << unit;
    EXPECT_NEAR(second, thicknessMemory, 0.1 * thicknessMemory) << unit;
    EXPECT_EQ(ofSurface["faces"], 3000);
    EXPECT_NEAR(ofSurface["thickness_mean"].get<double>() / unit, 4.9, 0.2);
    EXPECT_NEAR(ofVoxels["thickness_mean"].get<double>() / unit, 4.9, 0.2);
  }
}

TEST(UnitOfLength, BeyondWhatAHeaderCanMeanIsRefused) {
  for (const auto& [spacing, offset, said] :
       {std::tuple{1e-7, 0.0, "sizes from 1e-6 to 1e6 mm are read"},
        std::tuple{1e7, 0.0, "sizes from 1e-6 to 1e6 mm are read"},
        std::tuple{1.0, 2e7, "up to 1e7 mm are read"}}) {
    TemporaryFolder folder;
    Volume<Label> labels = eccentricBalls(spacing);
    labels.grid.origin[1] += offset;
    io::writeVolume(folder / "seg.nii.gz", labels);
    for (const std::string command : {"surface", "thickness"}) {
      const auto refused = explica({command, folder / "seg.nii.gz", "--out", folder / "out"});
      EXPECT_EQ(refused.exitCode, 2) << refused;
      EXPECT_NE(refused.err.find(said), std::string::npos) << refused;
    }
  }
}

}  // namespace
}  // namespace explica::testing
