// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// explica surface: what users type and what they get.

#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

/// Labels of a torus (white 3) in a ribbon (grey 2), oblique and away from the origin.
void writeTorus(const std::string& path, double tube) {
  Grid grid;
  grid.size = {56, 56, 40};
  grid.direction << std::cos(0.3), -std::sin(0.3), 0, std::sin(0.3), std::cos(0.3), 0, 0, 0, 1;
  const Point centre(12, -7, 30);
  grid.origin = centre - grid.direction * Vector(27.5, 27.5, 19.5);
  Volume<Label> labels(grid);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto s = grid.subscripts(v);
    const Vector p = grid.toWorld(Vector(s[0], s[1], s[2])) - centre;
    const double d = std::hypot(std::hypot(p.x(), p.y()) - 14, p.z());
    labels[v] = d < tube ? 3 : (d < tube + 3 ? 2 : 0);
  }
  io::writeVolume(path, labels);
}

TEST(SurfaceCommand, MakesATorusASphereAndSaysWhere) {
  TemporaryFolder folder;
  writeTorus(folder / "torus.nii.gz", 4);
  // The cut makes more than a twentieth of so small a surface.
  const auto made = explica({"surface", folder / "torus.nii.gz", "--faces", "4000", "--freesurfer",
                             "surf", "--accept", "corrected", "--out", folder / "out"});
  ASSERT_EQ(made.exitCode, 0) << made;
  for (const std::string name : {"white", "mid", "pial"}) {
    const auto mesh = io::readSurface(folder / ("out/" + name + ".surf.gii")).mesh;
    const auto condition = geometry::inspectMesh(mesh);
    EXPECT_TRUE(condition.closedManifold());
    EXPECT_EQ(condition.eulerCharacteristic, 2);
    EXPECT_NEAR(static_cast<double>(condition.faces), 4000, 40);  // long edges are split
    EXPECT_TRUE(geometry::findSelfIntersections(mesh).empty());
  }
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["euler_characteristic"], 2);
  EXPECT_EQ(summary["self_intersections"], 0);
  EXPECT_EQ(summary["defects_corrected"], 1);
  EXPECT_NEAR(summary["thickness_mean"].get<double>(), 3, 0.15);

  std::ifstream table(folder / "out/topology.tsv");
  std::string header, kind;
  double x = 0, y = 0, z = 0;
  std::getline(table, header);
  table >> kind >> x >> y >> z;
  EXPECT_EQ(kind, "handle");
  EXPECT_NEAR(std::hypot(x - 12, y + 7), 14, 1.5);
  EXPECT_NEAR(z, 30, 1);
  EXPECT_TRUE(fs::exists(folder / "out/surf/lh.white"));
  EXPECT_EQ(io::readVertexMaps(folder / "out/surf/lh.thickness").front().values.size(),
            summary["vertices"].get<std::size_t>());
}

TEST(SurfaceCommand, LeavesTheTorusAloneIfAsked) {
  TemporaryFolder folder;
  writeTorus(folder / "torus.nii.gz", 4);
  const auto made = explica({"surface", folder / "torus.nii.gz", "--faces", "4000", "--genus",
                             "keep", "--out", folder / "out"});
  ASSERT_EQ(made.exitCode, 0) << made;
  EXPECT_EQ(readJson(folder / "out/summary.json")["euler_characteristic"], 0);
}

TEST(SurfaceCommand, SaysWhatIsWrongWithTheNumbersFound) {
  TemporaryFolder folder;
  writeTorus(folder / "torus.nii.gz", 4);
  const auto absent =
      explica({"surface", folder / "torus.nii.gz", "--white-label", "9", "--out", folder / "out"});
  EXPECT_EQ(absent.exitCode, 2);
  EXPECT_NE(absent.err.find("label 9 absent (found 0, 2, 3)"), std::string::npos) << absent;
  const auto edge = explica({"surface", folder / "torus.nii.gz", "--white-label", "0",
                             "--grey-label", "2", "--out", folder / "out"});
  EXPECT_EQ(edge.exitCode, 2);
  EXPECT_NE(edge.err.find("touches the edge of the field of view"), std::string::npos) << edge;
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(SurfaceCommand, ScaledHeadersAreFlaggedAndScaledBack) {
  TemporaryFolder folder;
  // FreeSurfer's labels on a ball of 13 voxels, 0.1 mm each: no human hemisphere.
  Grid grid;
  grid.size = {40, 40, 40};
  grid.spacing = Vector::Constant(0.1);
  grid.origin = Point(3, -2, 1);
  Volume<Label> labels(grid);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto s = grid.subscripts(v);
    const double r = (Vector(s[0], s[1], s[2]) - Vector(19.5, 19.5, 19.5)).norm();
    labels[v] = r < 3 ? 4 : (r < 10 ? 2 : (r < 13 ? 3 : 0));
  }
  io::writeVolume(folder / "small.nii.gz", labels);
  const auto made = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> words = {
        "surface",  folder / "small.nii.gz", "--faces", "2000", "--out", folder / out,
        "--accept", "thickness-mean"};
    words.insert(words.end(), more.begin(), more.end());
    return explica(words);
  };
  const auto asStated = made("stated", {});
  EXPECT_EQ(asStated.exitCode, 0) << asStated;
  EXPECT_NE(asStated.err.find("--scale"), std::string::npos) << asStated;
  const auto scaled = made("scaled", {"--scale", "40"});
  EXPECT_EQ(scaled.exitCode, 0) << scaled;
  EXPECT_EQ(scaled.err.find("cerebrum holds"), std::string::npos) << scaled;
  const auto small = readJson(folder / "stated/summary.json");
  const auto large = readJson(folder / "scaled/summary.json");
  EXPECT_NEAR(large["thickness_mean"].get<double>(), 40 * small["thickness_mean"].get<double>(),
              0.05);
  EXPECT_NEAR(large["cerebrum_volume_ml"].get<double>(),
              64000 * small["cerebrum_volume_ml"].get<double>(), 5);
  EXPECT_EQ(made("none", {"--scale", "0"}).exitCode, 1);
}

TEST(SurfaceCommand, MakesSheetsOfABlockAndSaysSo) {
  TemporaryFolder folder;
  Grid grid;
  grid.size = {32, 32, 32};
  Volume<Label> labels(grid);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto s = grid.subscripts(v);
    const double r = (Vector(s[0], s[1], s[2]) - Vector(15.5, 15.5, 3)).norm();
    labels[v] = r < 8 ? 3 : (r < 13 ? 2 : 0);
  }
  io::writeVolume(folder / "block.nii.gz", labels);
  const auto made =
      explica({"surface", folder / "block.nii.gz", "--white-label", "3", "--grey-label", "2",
               "--faces", "2000", "--freesurfer", "surf", "--out", folder / "out"});
  ASSERT_EQ(made.exitCode, 0) << made;
  EXPECT_NE(made.err.find("runs out of the image"), std::string::npos) << made;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_TRUE(summary["sheet"]);
  EXPECT_EQ(summary["euler_characteristic"], 1);
  EXPECT_EQ(summary["rims"], 1);
  EXPECT_EQ(summary["self_intersections"], 0);
  EXPECT_NEAR(summary["thickness_mean_known"].get<double>(), 5, 0.1);
  const auto valid = io::readVertexMaps(folder / "out/valid.shape.gii").front().values;
  EXPECT_EQ((valid.array() == 0).count(), summary["vertices_cut_by_image"].get<Eigen::Index>());
  EXPECT_FALSE(fs::exists(folder / "out/sulc.shape.gii"));

  const auto refused =
      explica({"surface", folder / "block.nii.gz", "--sheet", "never", "--out", folder / "closed"});
  EXPECT_EQ(refused.exitCode, 2);
  EXPECT_NE(refused.err.find("--sheet"), std::string::npos) << refused;

  const auto unfolded = explica({"unfold", folder / "out/mid.surf.gii", "--surround", "none",
                                 "--center", "15.5,15.5,13.5", "--radius", "6", "--direction",
                                 "0,0,1", "--max-iterations", "3", "--out", folder / "unfolded"});
  EXPECT_EQ(unfolded.exitCode, 3) << unfolded;  // stopped early
  const auto flat = explica({"flatten", folder / "out/mid.surf.gii", "--out", folder / "flat"});
  EXPECT_EQ(flat.exitCode, 0) << flat;
}

/// Of each region in regions.tsv its mean thickness, mm.
std::map<std::string, double> thicknessByRegion(const std::string& file) {
  std::istringstream table(readText(file));
  std::map<std::string, double> means;
  std::string line;
  std::getline(table, line);
  while (std::getline(table, line)) {
    std::istringstream row(line);
    std::string index, name, vertices, area, mean;
    row >> index >> name >> vertices >> area >> mean;
    means[name] = std::stod(mean);
  }
  return means;
}

TEST(SurfaceCommand, RegionsHaveTheirThicknessHoweverCoarseTheMesh) {
  TemporaryFolder folder;
  Grid grid;
  grid.size = {48, 48, 48};
  Volume<Label> labels(grid), atlas(grid);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto s = grid.subscripts(v);
    const Vector p = Vector(s[0], s[1], s[2]) - Vector::Constant(23.5);
    // From 2 mm in -x to 6 mm in +x; a small region where it changes most.
    labels[v] = p.norm() < 14 ? 3 : p.norm() < 18 + 2 * p.x() / p.norm() ? 2 : 0;
    atlas[v] = p.z() > 0.9 * p.norm() && p.x() > 0 ? 7 : 8;
  }
  io::writeVolume(folder / "labels.nii.gz", labels);
  io::writeVolume(folder / "atlas.nii.gz", atlas);
  const auto regionsAt = [&](const std::string& faces) {
    const auto made =
        explica({"surface", folder / "labels.nii.gz", "--white-label", "3", "--grey-label", "2",
                 "--atlas", folder / "atlas.nii.gz", "--faces", faces, "--out", folder / faces});
    EXPECT_EQ(made.exitCode, 0) << made;
    return thicknessByRegion(folder / (faces + "/regions.tsv"));
  };
  const auto coarse = regionsAt("400"), fine = regionsAt("12000");
  EXPECT_EQ(fine.size(), 2);
  EXPECT_NEAR(fine.at("label7"), 4.5, 0.2);
  for (const auto& [name, mean] : fine) EXPECT_NEAR(coarse.at(name), mean, 0.001) << name;
}

}  // namespace
}  // namespace explica::testing
