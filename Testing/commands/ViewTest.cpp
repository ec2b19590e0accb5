// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Pictures without a display.

#include "Explica/Geometry/Fixtures.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VertexDataFile.h"
#include "Explica/Testing/Command.h"

#include <gtest/gtest.h>

namespace explica::testing {
namespace {

const CommandSetting kNoDisplay = {{}, {{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}}, {}, {}};

void writeSphere(const TemporaryFolder& folder) {
  const TriangleMesh mesh = geometry::makeFoldedSphere(4, 40);
  io::writeGiftiSurface(folder / "a.surf.gii", mesh);
  io::writeGiftiShape(folder / "a.shape.gii", {{"height", "mm", mesh.positions.col(2)}}, "Other");
}

TEST(View, DrawsTheSameBytesTwiceWithoutADisplay) {
  TemporaryFolder folder;
  writeSphere(folder);
  std::vector<std::string> pictures;
  for (const char* threads : {"1", "4"}) {
    const std::string file = folder / (std::string(threads) + ".png");
    const auto view =
        explica({"view", folder / "a.surf.gii", "--map", folder / "a.shape.gii", "--width", "300",
                 "--height", "200", "--threads", threads, "--screenshot", file},
                kNoDisplay);
    ASSERT_EQ(view.exitCode, 0) << view;
    pictures.push_back(readText(file));
  }
  EXPECT_EQ(pictures[0].compare(1, 3, "PNG"), 0);
  EXPECT_EQ(pictures[0], pictures[1]);
}

TEST(View, ShowsContoursOnAVolume) {
  TemporaryFolder folder;
  ASSERT_EQ(explica({"phantom", "cortex", "--size", "40", "--out", folder / "p"}).exitCode, 0);
  const auto plain = explica(
      {"view", folder / "p/t1.nii.gz", "--height", "300", "--screenshot", folder / "plain.png"},
      kNoDisplay);
  const auto lined = explica({"view", folder / "p/t1.nii.gz", folder / "p/white.surf.gii",
                              "--height", "300", "--screenshot", folder / "lined.png"},
                             kNoDisplay);
  EXPECT_EQ(plain.exitCode, 0) << plain;
  EXPECT_EQ(lined.exitCode, 0) << lined;
  EXPECT_NE(readText(folder / "plain.png"), readText(folder / "lined.png"));
}

TEST(View, MakesAFilmOfFrames) {
  TemporaryFolder folder;
  writeSphere(folder);
  ASSERT_NE(explica({"unfold", folder / "a.surf.gii", "--center", "0,0,40", "--radius", "14",
                     "--direction", "0,0,1", "--max-iterations", "3", "--frames", "3", "--out",
                     folder / "u"})
                .exitCode,
            2);
  const auto film =
      explica({"view", folder / "u", "--labels", folder / "u/region.label.gii", "--width", "160",
               "--height", "120", "--direction", "0,0,1", "--film", folder / "u.gif"},
              kNoDisplay);
  ASSERT_EQ(film.exitCode, 0) << film;
  EXPECT_EQ(readText(folder / "u.gif").substr(0, 6), "GIF89a");

  // Without options the region is coloured and seen from its viewpoint.
  const auto plain = explica(
      {"view", folder / "u", "--width", "160", "--height", "120", "--film", folder / "plain.gif"},
      kNoDisplay);
  ASSERT_EQ(plain.exitCode, 0) << plain;
  EXPECT_NE(readText(folder / "plain.gif"), readText(folder / "u.gif"));

  // A video where ffmpeg is installed, or a sentence that says so.
  const auto video = explica(
      {"view", folder / "u", "--width", "161", "--height", "120", "--film", folder / "u.mp4"},
      kNoDisplay);
  if (video.exitCode == 0) {
    EXPECT_EQ(readText(folder / "u.mp4").substr(4, 4), "ftyp");
  } else {
    EXPECT_EQ(video.exitCode, 4) << video;
    EXPECT_NE(video.err.find("ffmpeg is not installed"), std::string::npos) << video;
  }
  const auto other = explica({"view", folder / "u", "--film", folder / "u.avi"}, kNoDisplay);
  EXPECT_EQ(other.exitCode, 1) << other;
  EXPECT_NE(other.err.find(".webm"), std::string::npos) << other;
}

TEST(View, SaysWhichMapIsMissing) {
  TemporaryFolder folder;
  writeSphere(folder);
  const auto view = explica({"view", folder / "a.surf.gii", "--map", folder / "a.shape.gii",
                             "--map-name", "depth", "--screenshot", folder / "x.png"},
                            kNoDisplay);
  EXPECT_EQ(view.exitCode, 2);
  EXPECT_NE(view.err.find("height"), std::string::npos) << view;
}

}  // namespace
}  // namespace explica::testing
