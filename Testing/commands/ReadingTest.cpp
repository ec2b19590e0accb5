// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// How a file was understood stands in the record; where a file leaves it open, the user chooses.

#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VolumeFile.h"
#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

#include <cstring>

namespace explica::testing {
namespace {

/// A shell of tissue whose sform lies 5 mm beside its qform.
void writeTornPlacement(const std::string& path) {
  Grid grid;
  grid.size = {16, 16, 16};
  Volume<Label> labels(grid);
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto at = grid.subscripts(v);
    const double radius = (Vector(at[0], at[1], at[2]) - Vector::Constant(7.5)).norm();
    labels[v] = radius < 3 ? 1 : radius < 6 ? 2 : 3;
  }
  io::writeVolume(path, labels);
  std::string bytes = readText(path);
  const float x = 5;
  constexpr std::size_t kOffsetOfSformX = 280 + 12;
  std::memcpy(bytes.data() + kOffsetOfSformX, &x, sizeof x);
  writeText(path, bytes);
}

TEST(Reading, AnUndecidedPlacementIsRefusedAndAChosenOneIsRecordedAndKept) {
  const TemporaryFolder folder;
  const std::string seg = folder / "seg.nii";
  writeTornPlacement(seg);
  const auto thickness = [&](const std::string& out, std::vector<std::string> more) {
    std::vector<std::string> words = {"thickness", seg,       "--inner", "1",         "--tissue",
                                      "2",         "--quiet", "--out",   folder / out};
    words.insert(words.end(), more.begin(), more.end());
    return explica(words);
  };
  const auto refused = thickness("refused", {});
  EXPECT_EQ(refused.exitCode, 2) << refused;
  EXPECT_TRUE(contains(refused.err, "--xform qform or --xform sform")) << refused;
  EXPECT_TRUE(contains(refused.err, seg)) << refused;

  for (const auto& [word, x] : {std::pair{"qform", 0.0}, std::pair{"sform", 5.0}}) {
    const auto done = thickness(word, {"--xform", word});
    ASSERT_EQ(done.exitCode, 0) << done;
    const auto record = readJson(folder / (std::string(word) + "/provenance.json"));
    const auto understood = record["notes"]["SEG"];
    EXPECT_EQ(understood["placement"], word);
    EXPECT_EQ(understood["qform_code"], 1);
    EXPECT_EQ(understood["affine"][0][3], x);
    const Grid grid = io::readGrid(folder / (std::string(word) + "/thickness.nii.gz"));
    EXPECT_EQ(grid.origin[0], x);
  }
}

TEST(Reading, AFrameThatASurfaceDoesNotStateIsSaid) {
  const TemporaryFolder folder;
  const TriangleMesh ball = geometry::makeIcosphere(3, 20);
  Eigen::Index top = 0;
  ball.positions.col(2).maxCoeff(&top);
  io::writeSurface(folder / "ball.off", ball);
  const auto done =
      explica({"unfold", folder / "ball.off", "--vertex", std::to_string(top), "--radius", "8",
               "--direction", "0,0,1", "--max-iterations", "1", "--out", folder / "u"});
  EXPECT_TRUE(done.exitCode == 0 || done.exitCode == 3) << done;
  EXPECT_TRUE(contains(done.err, "--surface-space")) << done;
  EXPECT_EQ(readJson(folder / "u/provenance.json")["notes"]["SURFACE"]["space"], "not stated");
}

}  // namespace
}  // namespace explica::testing
