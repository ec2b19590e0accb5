// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// explica inflate on a generated cortex and on surfaces of real heads.

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/Testing/Command.h"
#include "Explica/Testing/Meshes.h"
#include "QuickRuns.h"
#include "RealSurfaces.h"

#include <gtest/gtest.h>

#include <sstream>

namespace explica::testing {
namespace {

TEST(InflateCommand, OpensAFoldedSurfaceAndSaysWhatItDid) {
  TemporaryFolder folder;
  const TriangleMesh mesh = geometry::makeFoldedSphere(4, 30.0, 0.4, 9);
  io::writeSurface(folder / "folded.surf.gii", mesh);
  const auto run =
      explica({"inflate", folder / "folded.surf.gii", "--frames", "4", "--out", folder / "out"});
  ASSERT_EQ(run.exitCode, 0) << run;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_LT(summary["visibility_initial"], 0.95);
  EXPECT_GE(summary["visibility_final"], 0.98);
  EXPECT_GE(summary["seen_final"], summary["visibility_final"]);
  EXPECT_LE(summary["area_error_mean"], 0.008);
  EXPECT_EQ(summary["self_intersections_final"], 0);
  EXPECT_EQ(summary["self_intersections_frames_max"], 0);
  EXPECT_EQ(summary["turned_over"], 0);
  EXPECT_EQ(summary["flag"], "");
  EXPECT_GT(summary["volume_final"], summary["volume_initial"]);
  const auto inflated = io::readSurface(folder / "out/inflated.surf.gii");
  EXPECT_EQ(inflated.metadata.geometricType, "Inflated");
  EXPECT_EQ(inflated.mesh.faces, mesh.faces);
  const auto freeSurfer = io::readSurface(folder / "out/lh.inflated");
  EXPECT_LT((freeSurfer.mesh.positions - inflated.mesh.positions).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_TRUE(geometry::findSelfIntersections(inflated.mesh).empty());
  for (int n = 0; n < 4; ++n) {
    const std::string frame = "out/frames/frame-000" + std::to_string(n) + ".surf.gii";
    EXPECT_TRUE(geometry::findSelfIntersections(io::readSurface(folder / frame).mesh).empty());
  }
  const auto report = explica({"report", folder / "out"});
  ASSERT_EQ(report.exitCode, 0) << report;
  const std::string page = readText(folder / "out/report.html");
  EXPECT_NE(page.find("data-scene=\""), std::string::npos);
  EXPECT_NE(page.find("Global visibility"), std::string::npos);
  const auto film = explica(
      {"view", folder / "out", "--film", folder / "film.gif", "--width", "120", "--height", "100"});
  EXPECT_EQ(film.exitCode, 0) << film;
}

TEST(InflateCommand, OpensTheFoldsOfAGeneratedCortex) {
  TemporaryFolder folder;
  const auto made = explica({"phantom", "cortex", "--size", "40", "--spacing", "2", "--depth",
                             "0.5", "--waves", "7", "--out", folder / "cortex"});
  ASSERT_EQ(made.exitCode, 0) << made;
  const auto run =
      explica({"inflate", folder / "cortex/white.surf.gii", "--out", folder / "inflated"});
  ASSERT_EQ(run.exitCode, 0) << run;
  const auto summary = readJson(folder / "inflated/summary.json");
  EXPECT_LT(summary["visibility_initial"], 0.8);
  EXPECT_GE(summary["visibility_final"], 0.98);
  EXPECT_LE(summary["area_error_mean"], 0.008);
  EXPECT_EQ(summary["self_intersections_final"], 0);
}

TEST(InflateCommand, PartsFacesThatCrossAtTheStart) {
  TemporaryFolder folder;
  TriangleMesh mesh = geometry::makeFoldedSphere(4, 30.0, 0.3, 7);
  const auto tip = mesh.faces(0, 0);
  mesh.positions.row(tip) *= -0.2;  // through the other side of its faces' neighbours
  io::writeSurface(folder / "crossed.surf.gii", mesh);
  const std::size_t before = geometry::findSelfIntersections(mesh).size();
  const auto run = explica({"inflate", folder / "crossed.surf.gii", "--out", folder / "out"});
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["self_intersections_initial"], before);
  EXPECT_LE(summary["self_intersections_final"], before);
  EXPECT_EQ(summary["self_intersections_new"], 0) << run;
}

TEST(InflateCommand, StopsAtItsLimitsAndSaysSo) {
  TemporaryFolder folder;
  io::writeSurface(folder / "folded.surf.gii", geometry::makeFoldedSphere(4, 30.0, 0.4, 9));
  const std::vector<std::string> words = {"inflate", folder / "folded.surf.gii", "--out",
                                          folder / "out"};
  const auto stopped = explica(words + std::vector<std::string>{"--max-iterations", "2"});
  EXPECT_EQ(stopped.exitCode, 3) << stopped;
  EXPECT_EQ(readJson(folder / "out/summary.json")["stop_reason"], "max-iterations");
  const auto resumed = explica(words + std::vector<std::string>{"--resume"});
  EXPECT_EQ(resumed.exitCode, 0) << resumed;
  const auto whole = explica({"inflate", folder / "folded.surf.gii", "--out", folder / "whole"});
  EXPECT_EQ(whole.exitCode, 0) << whole;
  EXPECT_EQ(readText(folder / "out/inflated.surf.gii"),
            readText(folder / "whole/inflated.surf.gii"));
}

TEST(InflateCommand, RefusesWhatIsNotOneClosedSurface) {
  TemporaryFolder folder;
  io::writeSurface(folder / "open.surf.gii", geometry::makeRectangle(6, 6, 10, 10));
  const auto open = explica({"inflate", folder / "open.surf.gii", "--out", folder / "out"});
  EXPECT_EQ(open.exitCode, 2) << open;
  io::writeSurface(folder / "two.surf.gii",
                   geometry::joined(geometry::makeIcosphere(2, 10),
                                    geometry::makeIcosphere(2, 10, Point(50, 0, 0))));
  const auto two = explica({"inflate", folder / "two.surf.gii", "--out", folder / "out"});
  EXPECT_EQ(two.exitCode, 2) << two;
  EXPECT_NE(two.err.find("2 pieces"), std::string::npos) << two;
}

TEST_F(RealSurfaces, AnInflatedHemisphereIsSeenFromAllAroundAtLessDistortionThanFreeSurfers) {
  TemporaryFolder folder;
  const std::string white = data() / "fsaverage5/white_right.gii.gz";
  const std::string shipped = data() / "fsaverage5/infl_right.gii.gz";
  const auto run = explica({"inflate", white, "--frames", "6", "--out", folder / "out"});
  ASSERT_EQ(run.exitCode, 0) << run;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_GE(summary["visibility_final"], 0.98);
  EXPECT_LE(summary["area_error_mean"], 0.01);
  EXPECT_EQ(summary["self_intersections_new"], 0);
  EXPECT_EQ(summary["self_intersections_frames_max"], 0);
  const auto compared = explica(
      {"compare", white, shipped, folder / "out/inflated.surf.gii", "--out", folder / "compared"});
  ASSERT_EQ(compared.exitCode, 0) << compared;
  const auto rows = readJson(folder / "compared/summary.json")["surfaces"];
  for (const char* key : {"area_error_mean", "edge_strain_mean", "angle_error_mean_deg",
                          "geodesic_error_local", "geodesic_error_all"}) {
    EXPECT_LT(rows[1][key], rows[0][key]) << key;
  }
  EXPECT_EQ(rows[1]["crossings"], 0);
  EXPECT_GE(rows[1]["seen"], 0.98);
}

}  // namespace
}  // namespace explica::testing
