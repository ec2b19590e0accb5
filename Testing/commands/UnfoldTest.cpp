// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Testing/Command.h"
#include "Explica/Testing/DepthBuffer.h"
#include "Explica/Unfolding/Region.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <sstream>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

const fs::path kData = EXPLICA_REAL_DATA;

/// Words that unfold about the vertex farthest along (x, y, z) from the centroid.
std::vector<std::string> unfoldAbout(const fs::path& surface, const Vector& along, double radius,
                                     const std::string& surround, const std::string& out) {
  const TriangleMesh mesh = io::readSurface(surface).mesh;
  const Point centroid = mesh.positions.colwise().mean().transpose();
  Eigen::Index farthest = 0;
  (void)((mesh.positions.rowwise() - centroid.transpose()) * along).maxCoeff(&farthest);
  char direction[80];
  std::snprintf(direction, sizeof direction, "--direction=%g,%g,%g", along[0], along[1], along[2]);
  return {"unfold",   surface.string(),
          "--vertex", std::to_string(farthest),
          "--radius", std::to_string(radius),
          direction,  "--surround",
          surround,   "--out",
          out};
}

class RealSurfaces : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(kData)) GTEST_SKIP() << "skipped: no real data";
  }
};

TEST_F(RealSurfaces, FixedSurroundingsOnTheAverageCortex) {
  const TemporaryFolder folder;
  auto words = unfoldAbout(kData / "fsaverage5/pial_left.gii.gz", Vector(-1, 0.2, 0.2), 25, "fixed",
                           folder / "out");
  words.insert(words.end(), {"--target-visibility", "0.97", "--frames", "6"});
  const auto result = explica(words);
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["region_faces"], 902);
  EXPECT_NEAR(summary["visibility_initial"], 0.356, 0.001);
  EXPECT_GE(summary["visibility_final"], 0.97);
  EXPECT_LE(summary["area_error_mean"], 0.003);
  EXPECT_LE(summary["edge_strain_mean"], 0.11);
  EXPECT_EQ(summary["self_intersections_initial"], 0);
  EXPECT_EQ(summary["self_intersections_final"], 0);
  EXPECT_EQ(summary["self_intersections_frames_max"], 0);
  EXPECT_GT(summary["seen_final"], summary["seen_initial"]);
  // The file itself, read back: the whole surface, exactly tested, its surroundings untouched.
  const TriangleMesh after = io::readSurface(folder / "out/unfolded.surf.gii").mesh;
  EXPECT_EQ(after.vertexCount(), 10242);
  EXPECT_TRUE(geometry::findSelfIntersections(after).empty());
  // A rasteriser with a depth buffer sees what the ray caster saw, before and after.
  const TriangleMesh before = io::readSurface(kData / "fsaverage5/pial_left.gii.gz").mesh;
  unfolding::RegionOptions where;
  where.vertex = std::stoi(words[3]);
  const auto region = unfolding::selectRegion(before, where);
  Point eye = Point::Zero();
  for (const std::int32_t v : region.vertices) eye += before.positions.row(v).transpose();
  eye =
      eye / static_cast<double>(region.vertices.size()) + 1000 * Vector(-1, 0.2, 0.2).normalized();
  for (const auto& [mesh, key] : {std::pair{before, "seen_initial"}, {after, "seen_final"}}) {
    const double share = seenShare(mesh, region.faces, renderFaces(mesh, eye, 3000));
    EXPECT_NEAR(summary[key].get<double>(), share, 0.005) << key;
  }
  for (int n = 0; n < 6; ++n) {
    EXPECT_TRUE(fs::exists(folder / ("out/frames/frame-000" + std::to_string(n) + ".surf.gii")));
  }
}

TEST_F(RealSurfaces, ADetachedPatchOfTheAverageCortexOpensFurther) {
  const TemporaryFolder folder;
  auto words = unfoldAbout(kData / "fsaverage5/pial_left.gii.gz", Vector(-1, 0, 0), 40, "none",
                           folder / "out");
  words.insert(words.end(), {"--target-visibility", "0.99"});
  ASSERT_EQ(explica(words).exitCode, 0);
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["region_faces"], 2254);
  EXPECT_GE(summary["visibility_final"], 0.99);
  EXPECT_LE(summary["area_error_mean"], 0.003);
  EXPECT_LE(summary["edge_strain_mean"], 0.08);
  EXPECT_EQ(summary["self_intersections_final"], 0);
}

TEST_F(RealSurfaces, AnIndividualAtFullResolutionWithItsNearContacts) {
  const TemporaryFolder folder;
  auto words = unfoldAbout(kData / "s1_pycortex_lh/pia_lh.gii", Vector(-1, 0.2, 0.2), 20, "none",
                           folder / "out");
  words.insert(words.end(), {"--target-visibility", "0.97"});
  ASSERT_EQ(explica(words).exitCode, 0);
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_GE(summary["visibility_final"], 0.97);
  EXPECT_LE(summary["area_error_mean"], 0.005);
  EXPECT_EQ(summary["self_intersections_final"], 0);
  EXPECT_FALSE(summary["warnings"].empty());  // the start intersects elsewhere, and is reported
  EXPECT_EQ(summary["self_intersections_initial"], 103);  // as an independent exact checker finds
  EXPECT_EQ(summary["self_intersections_initial_region"], 0);
  const std::string places = readText(folder / "out/intersections.tsv");
  EXPECT_EQ(std::count(places.begin(), places.end(), '\n'), 1 + 103);
}

TEST_F(RealSurfaces, AnIndividualWhoseSurfaceIntersectsIsRepaired) {
  const TemporaryFolder folder;
  auto words = unfoldAbout(kData / "s1_pycortex_lh/pia_lh.gii", Vector(-1, 0.2, 0.2), 20, "fixed",
                           folder / "out");
  words.insert(words.end(), {"--max-iterations", "2", "--repair"});
  ASSERT_EQ(explica(words).exitCode, 3);
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["self_intersections_initial"], 103);
  EXPECT_EQ(summary["self_intersections_repaired"], 103);
  EXPECT_EQ(summary["self_intersections_final"], 0);
  EXPECT_LE(summary["repair_move_max"], 1.0);  // mm; edges are 0.9 mm long
  EXPECT_LE(summary["repair_move_mean"], 0.1);
  EXPECT_LE(summary["repair_vertices_moved"], 2000);
}

std::vector<std::string> onFoldedSphere(const TemporaryFolder& folder) {
  const std::string surface = folder / "sphere.surf.gii";
  if (!fs::exists(surface)) {
    io::writeSurface(surface, geometry::makeFoldedSphere(4, 30.0));
  }
  return {"unfold", surface, "--center", "0,0,30", "--radius", "15", "--direction", "0,0,1"};
}

TEST(UnfoldCommand, ResumedRunsWriteTheBytesOfUninterruptedOnes) {
  const TemporaryFolder folder;
  auto words = onFoldedSphere(folder);
  auto whole = words, part = words;
  whole.insert(whole.end(), {"--max-iterations", "9", "--out", folder / "whole"});
  part.insert(part.end(), {"--max-iterations", "4", "--out", folder / "part"});
  EXPECT_EQ(explica(whole).exitCode, 3);
  EXPECT_EQ(explica(part).exitCode, 3);
  words.insert(words.end(), {"--max-iterations", "9", "--resume", "--out", folder / "part"});
  EXPECT_EQ(explica(words).exitCode, 3);
  for (const char* name : {"unfolded.surf.gii", "visibility.shape.gii", "distortion.shape.gii"}) {
    EXPECT_EQ(readText(folder / ("whole/" + std::string(name))),
              readText(folder / ("part/" + std::string(name))))
        << name;
  }
}

/// A folded sphere with one vertex pushed through its neighbours, inside the region or away from
/// it.
std::string writePierced(const TemporaryFolder& folder, const Point& about) {
  TriangleMesh mesh = geometry::makeFoldedSphere(4, 30.0);
  Eigen::Index nearest = 0;
  (void)(mesh.positions.rowwise() - about.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  mesh.positions.row(nearest) += Eigen::RowVector3d(8, 5, about.z() > 0 ? -4 : 4);
  io::writeSurface(folder / "pierced.surf.gii", mesh);
  return folder / "pierced.surf.gii";
}

TEST(UnfoldCommand, IntersectionsOfTheStartAreListedAndNeverMadeWorse) {
  for (const Point& about : {Point(0, 0, 30), Point(0, 0, -30)}) {
    const TemporaryFolder folder;
    const std::string surface = writePierced(folder, about);
    const auto before = geometry::findSelfIntersections(io::readSurface(surface).mesh);
    ASSERT_FALSE(before.empty());
    const auto result =
        explica({"unfold", surface, "--center", "0,0,30", "--radius", "15", "--direction", "0,0,1",
                 "--max-iterations", "12", "--out", folder / "out"});
    ASSERT_EQ(result.exitCode, 3) << result;
    const auto summary = readJson(folder / "out/summary.json");
    EXPECT_EQ(summary["self_intersections_initial"], before.size());
    EXPECT_EQ(summary["self_intersections_initial_region"] > 0, about.z() > 0);
    const auto after =
        geometry::findSelfIntersections(io::readSurface(folder / "out/unfolded.surf.gii").mesh);
    EXPECT_TRUE(std::includes(before.begin(), before.end(), after.begin(), after.end()));
    std::istringstream table(readText(folder / "out/intersections.tsv"));
    std::string line;
    std::getline(table, line);
    for (const geometry::FacePair& pair : before) {
      std::int32_t f = -1, g = -1;
      table >> f >> g;
      std::getline(table, line);
      EXPECT_EQ((geometry::FacePair{f, g}), pair);
      EXPECT_EQ(line.substr(line.size() - 2), "no");
    }
  }
}

TEST(UnfoldCommand, RepairPartsThemAndSaysHowFarVerticesMoved) {
  for (const Point& about : {Point(0, 0, 30), Point(0, 0, -30)}) {
    const TemporaryFolder folder;
    const std::string surface = writePierced(folder, about);
    const auto result =
        explica({"unfold", surface, "--center", "0,0,30", "--radius", "15", "--direction", "0,0,1",
                 "--max-iterations", "12", "--repair", "--out", folder / "out"});
    ASSERT_EQ(result.exitCode, 3) << result;
    const auto summary = readJson(folder / "out/summary.json");
    EXPECT_EQ(summary["self_intersections_repaired"], summary["self_intersections_initial"]);
    EXPECT_EQ(summary["self_intersections_final"], 0);
    EXPECT_GT(summary["repair_move_max"], 0);
    EXPECT_LT(summary["repair_move_max"], 12);  // the vertex was thrown 10 mm
    EXPECT_NE(result.err.find("parted by moving"), std::string::npos);
    const auto record = readText(folder / "out/provenance.json");
    EXPECT_NE(record.find("\"repair\": true"), std::string::npos);
    EXPECT_NE(record.find("parted by moving"), std::string::npos);
  }
}

TEST(UnfoldCommand, RefusesWhatCannotBeUnfoldedAndSaysWhy) {
  const TemporaryFolder folder;
  const auto words = onFoldedSphere(folder);
  const std::string surface = words[1];
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"unfold", surface});
    more.insert(more.end(), {"--out", folder / "out"});
    return explica(more);
  };
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"--center", "0,0,30", "--radius", "-3", "--direction", "0,0,1"}, "radius"},
      {{"--center", "0,0,30", "--radius", "500", "--direction", "0,0,1"}, "whole closed surface"},
      {{"--center", "0,0,30", "--radius", "0.001", "--direction", "0,0,1"}, "no face"},
      {{"--center", "0,0,30", "--radius", "15", "--viewpoint", "0,0,1"}, "inside the surface"},
      {{"--center", "0,0,30", "--radius", "15"}, "viewpoint"},
      {{"--center", "0,0,30", "--radius", "15", "--direction", "0,0,-1"}, "average visibility"},
      {{"--vertex", "999999", "--direction", "0,0,1"}, "none of the surface's vertices"}};
  for (const auto& [options, reason] : cases) {
    const auto result = run(options);
    EXPECT_EQ(result.exitCode, 2) << result;
    EXPECT_NE(result.err.find(reason), std::string::npos) << reason << "\n" << result.err;
  }
}

}  // namespace
}  // namespace explica::testing
