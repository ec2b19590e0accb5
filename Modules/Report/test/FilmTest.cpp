// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Film.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"

#include <gtest/gtest.h>

namespace explica::report {
namespace {

/// A ball that grows to the given radius.
std::vector<FilmFrame> growingBall(double last) {
  std::vector<FilmFrame> frames;
  for (int n = 0; n < 3; ++n) {
    const double radius = 10 + (last - 10) * n / 2;
    frames.push_back({geometry::makeIcosphere(3, radius), "frame " + std::to_string(n)});
  }
  return frames;
}

SurfacePictureOptions smallPicture() {
  SurfacePictureOptions options;
  options.width = 160;
  options.height = 120;
  return options;
}

/// Pixels of a row that are not white.
int drawnIn(const Picture& picture, int y) {
  int count = 0;
  for (int x = 0; x < picture.width; ++x) count += picture.pixel(x, y)[0] < 250 ? 1 : 0;
  return count;
}

TEST(Film, HoldsTheLargestFrameAndStandsStill) {
  const auto pictures = filmPictures(growingBall(30), {}, smallPicture());
  ASSERT_EQ(pictures.size(), 3u);
  const int middle = 55;
  const int first = drawnIn(pictures[0], middle), last = drawnIn(pictures[2], middle);
  EXPECT_NEAR(last / static_cast<double>(first), 3, 0.2) << "one scale for all frames";
  EXPECT_EQ(pictures[2].pixel(1, middle)[0], 255) << "nothing is cut off at the side";
}

TEST(Film, WritesItsCaptionBelow) {
  auto frames = growingBall(12);
  const auto with = filmPictures(frames, {}, smallPicture());
  frames[1].caption.clear();
  const auto without = filmPictures(frames, {}, smallPicture());
  EXPECT_EQ(with[0].rgb, without[0].rgb);
  EXPECT_NE(with[1].rgb, without[1].rgb);
}

TEST(Film, FillsThePictureWithItsFocus) {
  FilmLook look;
  const auto frames = growingBall(10);
  for (std::int32_t v = 0; v < frames[0].mesh.vertexCount(); ++v) {
    if (frames[0].mesh.positions(v, 2) > 9) look.view.focus.push_back(v);
  }
  const auto close = filmPictures(frames, look, smallPicture());
  const auto whole = filmPictures(frames, {}, smallPicture());
  EXPECT_GT(drawnIn(close[0], 100), drawnIn(whole[0], 100));
}

TEST(Film, RefusesNoFramesAndUnlikeOnes) {
  EXPECT_THROW((void)filmPictures({}, {}), InvalidInput);
  auto frames = growingBall(12);
  frames[1].mesh = geometry::makeIcosphere(2, 10);
  EXPECT_THROW((void)filmPictures(frames, {}), InvalidInput);
}

}  // namespace
}  // namespace explica::report
