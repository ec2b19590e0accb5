// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// explica repair: what users type and what they get.

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Testing/Command.h"
#include "Explica/Testing/Stops.h"

#include <gtest/gtest.h>

#include <cstring>

namespace explica::testing {
namespace {

namespace fs = std::filesystem;

/// Two spheres that overlap: banks that passed through each other.
TriangleMesh crossed() {
  return geometry::joined(geometry::makeIcosphere(4, 10.0),
                          geometry::makeIcosphere(4, 10.0, Point(19.8, 0.3, 0.2)));
}

TEST(Repair, PartsAFreeSurferSurfaceInItsOwnFile) {
  TemporaryFolder folder;
  Grid volume;  // surface RAS differs from scanner RAS
  volume.size = {256, 256, 256};
  volume.direction << -1, 0, 0, 0, 0, 1, 0, -1, 0;
  volume.origin = {140, -110, 120};
  io::writeFreeSurferSurface(folder / "lh.white", crossed(), volume);
  const CommandResult result =
      explica({"repair", folder / "lh.white", "--max-move", "5", "--out", folder / "out"});
  ASSERT_EQ(result.exitCode, 0) << result;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_GT(summary["pairs_before"], 0);
  EXPECT_EQ(summary["pairs_after"], 0);
  EXPECT_EQ(summary["verdict"], "right");
  EXPECT_TRUE(summary["reasons"].empty());
  const auto meaning = readJson(folder / "out/provenance.json")["meanings"]["pairs_after"];
  EXPECT_EQ(meaning["judgement"], "good");
  EXPECT_EQ(meaning["limits"][0]["most"], 0);
  const TriangleMesh repaired = io::readSurface(folder / "out/lh.white").mesh,
                     gifti = io::readSurface(folder / "out/lh.white.surf.gii").mesh;
  EXPECT_TRUE(geometry::findSelfIntersections(repaired).empty());
  EXPECT_LT((repaired.positions - gifti.positions).cwiseAbs().maxCoeff(), 1e-5);

  // Bytes of the vertices that did not move, of faces, comment and footer are the file's own.
  const std::string before = readText(folder / "lh.white"),
                    after = readText(folder / "out/lh.white");
  ASSERT_EQ(before.size(), after.size());
  std::size_t differ = 0;
  for (std::size_t n = 0; n < before.size(); ++n) differ += before[n] != after[n];
  const std::size_t moved = summary["vertices_moved"];
  EXPECT_GT(moved, 0U);
  EXPECT_LE(differ, 12 * moved);
  const Eigen::VectorXd moves = io::readVertexMaps(folder / "out/moved.shape.gii")[0].values;
  EXPECT_EQ(static_cast<std::size_t>((moves.array() > 0).count()), moved);
  EXPECT_NEAR(moves.maxCoeff(), summary["move_max"], 1e-6);
  EXPECT_NE(readText(folder / "out/intersections.tsv").find("\tyes\n"), std::string::npos);
}

TEST(Repair, SaysWhatItCannotMend) {
  TemporaryFolder folder;
  io::writeSurface(folder / "a.surf.gii", crossed());
  const CommandResult result =
      explica({"repair", folder / "a.surf.gii", "--max-move", "0.0001", "--out", folder / "out"});
  EXPECT_EQ(result.exitCode, 3) << result;
  EXPECT_NE(result.err.find("--max-move"), std::string::npos) << result;
  const auto summary = readJson(folder / "out/summary.json");
  EXPECT_EQ(summary["pairs_after"], summary["pairs_before"]);
  EXPECT_EQ(summary["verdict"], "stopped");
  ASSERT_EQ(summary["reasons"].size(), 2U);
  EXPECT_NE(summary["reasons"][1].get<std::string>().find("expected 0"), std::string::npos);
  const TriangleMesh before = io::readSurface(folder / "a.surf.gii").mesh,
                     after = io::readSurface(folder / "out/a.surf.gii").mesh;
  EXPECT_EQ(before.positions, after.positions);
  EXPECT_NE(readText(folder / "out/intersections.tsv").find("\tno\n"), std::string::npos);
}

/// A limit that has passed before any work begins.
TEST(Repair, StoppedItWritesTheSurfaceAsFarAsItCame) {
  TemporaryFolder folder;
  io::writeSurface(folder / "a.surf.gii", crossed());
  const std::vector<std::string> words = {
      "repair", folder / "a.surf.gii", "--max-move", "5", "--force", "--out", folder / "out"};
  const long checks = checksFor(words);
  int written = 0;
  for (long check = 1; check <= std::min(checks, 40L); ++check) {
    std::filesystem::remove_all(folder / "out");
    const CommandResult result = explica(words, stopAtCheck(check));
    EXPECT_TRUE(isInterrupted(result)) << result;
    if (!std::filesystem::exists(folder / "out")) continue;
    ++written;
    const auto summary = readJson(folder / "out/summary.json");
    EXPECT_EQ(summary["termination"], "interrupted");
    EXPECT_LE(summary["pairs_after"], summary["pairs_before"]);
    EXPECT_EQ(explica({"verify", folder / "out"}).exitCode, 0);
  }
  EXPECT_GT(written, 0);
}

TEST(Repair, TakesSurfacesThatCorrespondOnly) {
  TemporaryFolder folder;
  io::writeSurface(folder / "a.surf.gii", geometry::makeIcosphere(2, 10.0));
  io::writeSurface(folder / "b.surf.gii", geometry::makeIcosphere(3, 12.0));
  const CommandResult result =
      explica({"repair", folder / "a.surf.gii", folder / "b.surf.gii", "--out", folder / "out"});
  EXPECT_EQ(result.exitCode, 2);
  EXPECT_NE(result.err.find("faces differ"), std::string::npos) << result;
}

/// The surfaces of two people, as other programs made them.
TEST(Repair, PartsEveryCrossingOfRealSurfaces) {
  const fs::path data = EXPLICA_REAL_DATA;
  if (!fs::exists(data)) GTEST_SKIP() << "skipped: no real data";
  TemporaryFolder folder;
  io::LoadedSurface mid = io::readSurface(data / "s1_pycortex_lh/wm_lh.gii");
  mid.mesh.positions =
      ((mid.mesh.positions + io::readSurface(data / "s1_pycortex_lh/pia_lh.gii").mesh.positions) /
       2)
          .eval();
  io::writeGiftiSurface(folder / "mid.surf.gii", mid.mesh, mid.metadata);
  struct Case {
    std::vector<std::string> files;
    int pairs;
  };
  const std::string s1 = (data / "s1_pycortex_lh").string() + "/",
                    fs5 = (data / "fsaverage5/fs_binary").string() + "/";
  for (const Case& c :
       {Case{{s1 + "wm_lh.gii", s1 + "pia_lh.gii"}, 112}, Case{{folder / "mid.surf.gii"}, 14},
        Case{{fs5 + "rh.white", fs5 + "rh.pial"}, 6}}) {
    std::vector<std::string> words = {"repair"};
    words.insert(words.end(), c.files.begin(), c.files.end());
    words.insert(words.end(), {"--out", folder / "out", "--force"});
    const CommandResult result = explica(words);
    ASSERT_EQ(result.exitCode, 0) << result;
    const auto summary = readJson(folder / "out/summary.json");
    EXPECT_EQ(summary["pairs_before"], c.pairs);
    EXPECT_EQ(summary["pairs_after"], 0);
    for (const auto& surface : summary["surfaces"]) {
      EXPECT_EQ(surface["pairs_after"], 0);
      EXPECT_LE(surface["move_mean"], 0.06);
      EXPECT_LE(surface["move_max"], 0.75);
    }
  }
}

}  // namespace
}  // namespace explica::testing
