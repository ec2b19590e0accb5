// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// explica regions, resample, smooth: what users type and what they get, beside FreeSurfer's tables
// and Connectome Workbench.

#include "Explica/Geometry/MeshMeasures.h"
#include "QuickRuns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <sstream>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

const fs::path kSharedData = EXPLICA_REAL_DATA;

/// Rows of a `.stats` file: words after the region's name.
std::map<std::string, std::vector<std::string>> statsRows(const fs::path& path) {
  std::map<std::string, std::vector<std::string>> rows;
  std::istringstream text(readText(path.string()));
  for (std::string line; std::getline(text, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    std::string name, word;
    words >> name;
    while (words >> word) rows[name].push_back(word);
  }
  return rows;
}

TEST(Regions, ReproducesFreeSurfersTableOfItsOwnSurfaces) {
  const fs::path bert = kSharedData / "bert_freesurfer";
  if (!fs::exists(bert)) GTEST_SKIP() << "skipped: no real data";
  for (const std::string side : {"lh", "rh"}) {
    TemporaryFolder folder;
    const fs::path given = side == "lh" ? bert : bert / "surf";  // the subject, or its surfaces
    const auto result =
        explica({"regions", given.string(), "--atlas",
                 (bert / "label" / (side + ".aparc.annot")).string(), "--out", folder / "out"});
    ASSERT_EQ(result.exitCode, 0) << result;
    const auto ours = statsRows(folder / ("out/" + side + ".aparc.stats"));
    const auto theirs = statsRows(bert / "stats" / (side + ".aparc.stats"));
    ASSERT_EQ(ours.size(), theirs.size());
    for (const auto& [name, row] : theirs) {
      ASSERT_TRUE(ours.contains(name)) << name;
      for (const int column : {0, 1, 3, 4}) {  // vertices, area, mean thickness, its deviation
        EXPECT_EQ(ours.at(name)[column], row[column]) << side << " " << name << " " << column;
      }
    }
    EXPECT_NE(readText(folder / "out/regions.tsv").find("bert_freesurfer\tL\taparc\tinsula\tarea"),
              side == "lh" ? std::string::npos : 0);
  }
}

TEST(Regions, TellsSizesOfAShell) {
  TemporaryFolder folder;
  writeMapAndRegions(folder);
  const auto result =
      explica({"regions", folder.path().string(), "--atlas", folder / "lh.regions.label.gii",
               "--map", folder / "thickness.shape.gii", "--person", "01", "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto rows = statsRows(folder / "out/lh.regions.stats");
  ASSERT_EQ(rows.size(), 2U);
  // Zones of spheres of 10 and 14 mm, of the share of the sphere that they take.
  const TriangleMesh white = geometry::makeIcosphere(3, 10.0);
  const double share = std::stod(rows.at("front")[1]) / geometry::vertexAreas(white).sum();
  EXPECT_NEAR(share, 0.35, 0.02);
  EXPECT_NEAR(std::stod(rows.at("front")[2]), share * 4 * kPi / 3 * (2744 - 1000), 80);
  EXPECT_NE(readText(folder / "out/regions.tsv").find("01\tL\tregions\tback\tvolume\t"),
            std::string::npos);
}

/// A measure of a region in regions.tsv.
double measureOf(const fs::path& table, const std::string& region, const std::string& measure) {
  std::istringstream text(readText(table.string()));
  const std::string wanted = "\t" + region + "\t" + measure + "\t";
  for (std::string line; std::getline(text, line);) {
    const auto at = line.find(wanted);
    if (at != std::string::npos) return std::stod(line.substr(at + wanted.size()));
  }
  return kNaN;
}

TEST(Regions, VolumeAndCurvatureAreTheSameWhicheverWayFacesRun) {
  TemporaryFolder folder;
  writeMapAndRegions(folder);
  const std::vector<std::string> words = {
      "regions", folder.path().string(), "--atlas", folder / "lh.regions.label.gii", "--force",
      "--out",   folder / "out"};
  ASSERT_EQ(explica(words).exitCode, 0);
  const std::string asked = readText(folder / "out/regions.tsv");
  for (const char* name : {"white.surf.gii", "pial.surf.gii"}) {
    TriangleMesh mesh = io::readSurface(folder / name).mesh;
    mesh.faces.col(1).swap(mesh.faces.col(2));
    io::writeGiftiSurface(folder / name, mesh);
  }
  ASSERT_EQ(explica(words).exitCode, 0);
  EXPECT_EQ(readText(folder / "out/regions.tsv"), asked);
}

// Weighed by the white surface, crowns count too little: a tenth of a millimetre in a real cortex.
TEST(Regions, ThicknessIsTheMeanOverTheMiddleSurface) {
  TemporaryFolder folder;
  writeMapAndRegions(folder);
  const TriangleMesh white = geometry::makeIcosphere(3, 10.0);
  TriangleMesh pial = white;
  Eigen::VectorXd thickness(white.vertexCount());
  for (Eigen::Index v = 0; v < white.vertexCount(); ++v) {
    const Point x = white.positions.row(v);
    thickness[v] = 3 + 0.25 * x.x();  // 0.5 to 5.5 mm
    pial.positions.row(v) *= 1 + thickness[v] / 10;
  }
  thickness[0] = 0;
  io::writeGiftiSurface(folder / "pial.surf.gii", pial);
  io::writeGiftiShape(folder / "thickness.shape.gii", {{"thickness", "mm", thickness}},
                      "CortexLeft");
  const Eigen::VectorXd areas =
      geometry::vertexAreas({0.5 * (white.positions + pial.positions), white.faces});
  const auto keys = io::readVertexLabels(folder / "lh.regions.label.gii").keys;
  double sum = 0, area = 0;
  for (Eigen::Index v = 0; v < keys.size(); ++v) {
    if (keys[v] != 1 || thickness[v] == 0) continue;
    sum += thickness[v] * areas[v];
    area += areas[v];
  }
  const auto result = explica({"regions", folder.path().string(), "--atlas",
                               folder / "lh.regions.label.gii", "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  EXPECT_NEAR(measureOf(folder / "out/regions.tsv", "front", "thickness_mean"), sum / area, 1e-4);
}

/// Largest difference of two files' first maps over the range of the first.
double differenceOverRange(const std::string& a, const std::string& b) {
  const Eigen::VectorXd x = io::readVertexMaps(a).front().values,
                        y = io::readVertexMaps(b).front().values;
  return (x - y).cwiseAbs().maxCoeff() / (x.maxCoeff() - x.minCoeff());
}

class BesideWorkbenchOnSpheres : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(kSharedData / "fs_LR")) GTEST_SKIP() << "skipped: no real data";
    if (runProgram({"which", "wb_command"}).exitCode != 0) GTEST_SKIP() << "skipped: no wb_command";
    for (const std::string name : {"sphere", "white"}) {
      TriangleMesh mesh = io::readSurface(fiveFolder_ / ("lh." + name)).mesh;
      io::SurfaceMetadata metadata;
      metadata.structure = "CortexLeft";
      io::writeGiftiSurface(folder_ / (name + ".surf.gii"), mesh, metadata);
    }
    const Eigen::VectorXd sulc = io::readVertexMaps(fiveFolder_ / "lh.sulc").front().values;
    io::writeGiftiShape(folder_ / "sulc.shape.gii", {{"sulc", "", sulc}}, "CortexLeft");
  }
  void workbench(std::vector<std::string> words) {
    words.insert(words.begin(), "wb_command");
    const auto result = runProgram(words);
    ASSERT_EQ(result.exitCode, 0) << result;
  }

  fs::path fiveFolder_ = kSharedData / "fsaverage5/fs_binary";
  std::string fsLR_ =
      (kSharedData / "fs_LR/fs_LR-deformed_to-fsaverage.L.sphere.32k_fs_LR.surf.gii").string();
  TemporaryFolder folder_;
};

TEST_F(BesideWorkbenchOnSpheres, MapsAreTheSameUpAndDown) {
  // Up to fs_LR's 32,492 vertices and down again, areas of the white surface and of spheres.
  workbench({"-metric-resample", folder_ / "sulc.shape.gii", folder_ / "sphere.surf.gii", fsLR_,
             "ADAP_BARY_AREA", folder_ / "up.shape.gii", "-area-surfs", folder_ / "white.surf.gii",
             fsLR_});
  auto result =
      explica({"resample", folder_ / "sulc.shape.gii", "--from", folder_ / "sphere.surf.gii",
               "--to", "fs_LR-32k", "--template", (kSharedData / "fs_LR").string(), "--areas",
               folder_ / "white.surf.gii", "--out", folder_ / "up"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const std::string up = folder_ / "up/sulc_space-fsLR_den-32k.shape.gii";
  EXPECT_LT(differenceOverRange(folder_ / "up.shape.gii", up), 1e-4);

  workbench({"-metric-resample", up, fsLR_, folder_ / "sphere.surf.gii", "ADAP_BARY_AREA",
             folder_ / "down.shape.gii", "-area-surfs", fsLR_, folder_ / "white.surf.gii"});
  result = explica({"resample", up, "--from", fsLR_, "--to", folder_ / "sphere.surf.gii", "--areas",
                    fsLR_ + "," + folder_ / "white.surf.gii", "--out", folder_ / "down"});
  ASSERT_EQ(result.exitCode, 0) << result;
  EXPECT_LT(differenceOverRange(folder_ / "down.shape.gii",
                                folder_ / "down/sulc_space-fsLR_den-32k_space-sphere_den-10k"
                                          ".shape.gii"),
            1e-4);
}

TEST_F(BesideWorkbenchOnSpheres, LabelsAreTheSame) {
  const Eigen::VectorXd sulc = io::readVertexMaps(folder_ / "sulc.shape.gii").front().values;
  io::LabelMap labels{"depth", {}, {{0, "crown"}, {1, "wall"}, {2, "fundus"}}};
  labels.keys = (sulc.array() > -0.5).cast<Label>() + (sulc.array() > 0.5).cast<Label>();
  io::writeGiftiLabel(folder_ / "depth.label.gii", labels, "CortexLeft");
  workbench({"-label-resample", folder_ / "depth.label.gii", folder_ / "sphere.surf.gii", fsLR_,
             "ADAP_BARY_AREA", folder_ / "wb.label.gii", "-area-surfs", folder_ / "sphere.surf.gii",
             fsLR_});
  const auto result =
      explica({"resample", folder_ / "depth.label.gii", "--from", folder_ / "sphere.surf.gii",
               "--to", fsLR_, "--out", folder_ / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  std::string file;
  for (const auto& entry : fs::directory_iterator(folder_ / "out")) {
    if (entry.path().string().ends_with(".label.gii")) file = entry.path().string();
  }
  const auto ours = io::readVertexLabels(file).keys,
             theirs = io::readVertexLabels(folder_ / "wb.label.gii").keys;
  EXPECT_LE((ours.array() != theirs.array()).count(), 3);  // votes that are equal but for rounding
}

TEST(Resample, FsLRStandsOnFsaverageWhereTheHcpPutsIt) {
  const fs::path sphere =
      kSharedData / "fsaverage/surf/fsaverage_std_sphere.L.164k_fsavg_L.surf.gii";
  if (!fs::exists(sphere)) GTEST_SKIP() << "skipped: no real data";
  TemporaryFolder folder;
  // fsaverage's own places as a surface, carried to fs_LR, are fs_LR's places on fsaverage.
  const auto result =
      explica({"resample", sphere.string(), "--from", sphere.string(), "--to", "fs_LR-32k",
               "--template", (kSharedData / "fs_LR").string(), "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const TriangleMesh ours =
      io::readSurface(folder /
                      "out/fsaverage_std_sphere.L.164k_fsavg_L_space-fsLR_den-32k.surf.gii")
          .mesh;
  const TriangleMesh theirs =
      io::readSurface(kSharedData / "fs_LR/fs_LR-deformed_to-fsaverage.L.sphere.32k_fs_LR.surf.gii")
          .mesh;
  EXPECT_EQ(ours.faces, theirs.faces);
  EXPECT_LT((ours.positions - theirs.positions).rowwise().norm().maxCoeff(), 0.005);
}

TEST(Resample, KeepsEachFilesFormat) {
  TemporaryFolder folder;
  writeMapAndRegions(folder);
  io::writeFreeSurferCurv(folder / "lh.z", geometry::makeIcosphere(3, 10.0).positions.col(2), 1280);
  const auto result =
      explica({"resample", folder / "thickness.shape.gii", folder / "lh.regions.label.gii",
               folder / "lh.z", folder / "pial.surf.gii", "--from", folder / "white.surf.gii",
               "--to", "fsaverage4", "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  EXPECT_EQ(io::readVertexMaps(folder / "out/thickness_space-fsaverage_den-3k.shape.gii").size(),
            1U);
  EXPECT_EQ(io::readVertexLabels(folder / "out/lh.regions_space-fsaverage_den-3k.label.gii", 2562)
                .table.size(),
            3U);
  EXPECT_NEAR(io::readVertexMaps(folder / "out/lh.z_space-fsaverage_den-3k").front().values[0], 10,
              0.2);
  const TriangleMesh pial =
      io::readSurface(folder / "out/pial_space-fsaverage_den-3k.surf.gii").mesh;
  EXPECT_EQ(pial.faceCount(), 5120);
  EXPECT_NEAR(pial.positions.rowwise().norm().mean(), 14, 0.1);
}

TEST(Resample, SumsOfAmountsStayByEveryMethod) {
  TemporaryFolder folder;
  const TriangleMesh sphere = geometry::makeIcosphere(5, 10.0);
  io::writeSurface(folder / "sphere.surf.gii", sphere);
  const Eigen::VectorXd areas = geometry::vertexAreas(sphere);
  for (const char* name : {"area.shape.gii", "map.shape.gii"}) {
    io::writeGiftiShape(folder / name, {{"area", "mm^2", areas}}, "CortexLeft");
  }
  for (const char* method : {"adaptive", "barycentric", "nearest"}) {
    const auto result =
        explica({"resample", folder / "map.shape.gii", "--amounts", folder / "area.shape.gii",
                 "--from", folder / "sphere.surf.gii", "--to", "fsaverage3", "--method", method,
                 "--force", "--out", folder / "out"});
    ASSERT_EQ(result.exitCode, 0) << result;
    const auto found = io::readVertexMaps(folder / "out/area_space-fsaverage_den-642.shape.gii");
    EXPECT_NEAR(found.front().values.sum(), areas.sum(), 1e-5 * areas.sum()) << method;
  }
}

TEST(Resample, RefusesASphereThatIsNotInRegisterWithTheTargetsName) {
  TemporaryFolder folder;
  writeMapAndRegions(folder);
  ASSERT_EQ(explica({"sphere", folder / "white.surf.gii", "--out", folder / "sphere"}).exitCode, 0);
  const std::string sphere = folder / "sphere/sphere.surf.gii";
  const auto refused = explica({"resample", folder / "thickness.shape.gii", "--from", sphere,
                                "--to", "fsaverage4", "--out", folder / "out"});
  EXPECT_EQ(refused.exitCode, 2) << refused;
  EXPECT_NE(refused.err.find("is not registered"), std::string::npos) << refused;
  EXPECT_FALSE(std::filesystem::exists(folder / "out"));
  const auto named = explica({"resample", folder / "thickness.shape.gii", "--from", sphere, "--to",
                              "fsaverage4", "--space", "own", "--out", folder / "out"});
  EXPECT_EQ(named.exitCode, 0) << named;
}

TEST(Smooth, SaysHowSmoothTheMapsAre) {
  TemporaryFolder folder;
  const TriangleMesh ball = geometry::makeIcosphere(5, 40);
  io::writeSurface(folder / "ball.surf.gii", ball);
  std::mt19937 random(1);
  std::vector<io::VertexMap> noise(8);
  for (io::VertexMap& map : noise) {
    map = {"noise", "", Eigen::VectorXd(ball.vertexCount())};
    for (double& value : map.values) value = std::normal_distribution<double>()(random);
  }
  io::writeGiftiShape(folder / "noise.func.gii", noise, "Other");
  const auto result = explica({"smooth", folder / "noise.func.gii", "--surface",
                               folder / "ball.surf.gii", "--fwhm", "12", "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_NEAR(summary["fwhm"], 12, 0.8);
  EXPECT_LT(summary["maps"][0]["fwhm_before"], 2);
  EXPECT_EQ(io::readVertexMaps(folder / "out/noise_fwhm-12.func.gii", ball.vertexCount()).size(),
            8U);
}

}  // namespace
}  // namespace explica::testing
