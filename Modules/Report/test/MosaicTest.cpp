// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Mosaic.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace explica::report {
namespace {

SliceFrame axialAt(double z) {
  SliceFrame frame;
  frame.axis = SliceAxis::Axial;
  frame.position = z;
  frame.pixel = 0.25;
  frame.width = frame.height = 400;
  return frame;
}

TEST(CutPolylines, ASphereIsCutInOneClosedCircleOfTheRightRadius) {
  const TriangleMesh sphere = geometry::makeIcosphere(5, 30);
  const auto lines = cutPolylines(sphere, axialAt(10.0001));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].front(), lines[0].back());
  const double expected = std::sqrt(30 * 30 - 10 * 10) / 0.25;
  double length = 0;
  for (std::size_t i = 0; i < lines[0].size(); ++i) {
    EXPECT_NEAR((lines[0][i] - Eigen::Vector2d(200, 200)).norm(), expected, 0.01 * expected);
    if (i > 0) length += (lines[0][i] - lines[0][i - 1]).norm();
  }
  EXPECT_NEAR(length, 2 * kPi * expected, 0.01 * length);
}

TEST(CutPolylines, AnOpenSurfaceIsCutFromRimToRim) {
  TriangleMesh strip;
  strip.positions.resize(4, 3);
  strip.positions << -5, 0, -1, 5, 0, -1, 5, 0, 1, -5, 0, 1;
  strip.faces.resize(2, 3);
  strip.faces << 0, 1, 2, 0, 2, 3;
  const auto lines = cutPolylines(strip, axialAt(0.2));
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].size(), 3u);
  EXPECT_NEAR(std::abs(lines[0].front().x() - lines[0].back().x()), 10 / 0.25, 1e-9);
}

TEST(DirectionLetters, FollowTheConvention) {
  SliceFrame frame = axialAt(0);
  EXPECT_EQ(directionLetters(frame), (std::array{'L', 'R', 'A', 'P'}));
  frame.leftOnRight = true;
  EXPECT_EQ(directionLetters(frame), (std::array{'R', 'L', 'A', 'P'}));
  frame.axis = SliceAxis::Coronal;
  EXPECT_EQ(directionLetters(frame), (std::array{'R', 'L', 'S', 'I'}));
  frame.axis = SliceAxis::Sagittal;
  EXPECT_EQ(directionLetters(frame), (std::array{'A', 'P', 'S', 'I'}));
}

/// Bright where x > 0, on a grid whose first axis runs to the left.
Volume<float> brightRight() {
  Grid grid;
  grid.size = {20, 20, 20};
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  axes(0, 0) = -1;
  grid.direction = axes;
  grid.origin = Point(9.5, -9.5, -9.5);
  Volume<float> image(grid, 10.0f);
  for (std::size_t v = 0; v < image.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    if (grid.toWorld(Vector(i, j, k)).x() > 0) image[v] = 100;
  }
  return image;
}

TEST(Mosaic, TheRightSideIsWhereItsLetterStands) {
  for (const auto convention : {SideConvention::Neurological, SideConvention::Radiological}) {
    MosaicOptions options;
    options.perRow = 3;
    options.tileHeight = 40;
    options.convention = convention;
    const SliceMosaic mosaic = makeMosaic(brightRight(), {}, options);
    ASSERT_EQ(mosaic.rows.size(), 3u);
    const MosaicTile& tile = mosaic.rows[0][1];
    const bool rightOnRight = tile.letters[1] == "R";
    EXPECT_EQ(rightOnRight, convention == SideConvention::Neurological);
    const int y = tile.picture.height / 2, quarter = tile.picture.width / 4;
    const int bright = rightOnRight ? 3 * quarter : quarter;
    const int dark = rightOnRight ? quarter : 3 * quarter;
    EXPECT_GT(tile.picture.pixel(bright, y)[0], tile.picture.pixel(dark, y)[0] + 50);
  }
}

TEST(Mosaic, HasEveryOutlineInEveryTile) {
  const TriangleMesh sphere = geometry::makeIcosphere(3, 6);
  MosaicOptions options;
  options.perRow = 7;
  options.tileHeight = 30;
  const SliceMosaic mosaic = makeMosaic(brightRight(), {{&sphere, "ball", "#ff0000"}}, options);
  for (const auto& row : mosaic.rows) {
    EXPECT_EQ(row.size(), 7u);
    for (const MosaicTile& tile : row) {
      ASSERT_EQ(tile.paths.size(), 1u);
      EXPECT_EQ(tile.paths[0].front(), 'M');
    }
  }
}

TEST(Mosaic, RefusesWhatShowsNothing) {
  Volume<float> empty = brightRight();
  std::fill(empty.data.begin(), empty.data.end(), 0.0f);
  EXPECT_THROW((void)makeMosaic(empty, {}), InvalidInput);
  MosaicOptions none;
  none.perRow = 0;
  EXPECT_THROW((void)makeMosaic(brightRight(), {}, none), InvalidInput);
}

TEST(Mosaic, CloseUpsAreCentredOnTheirPlaces) {
  Grid grid;
  grid.size = {60, 60, 60};
  Volume<float> image(grid, 1.0F);
  const TriangleMesh sphere = [] {
    TriangleMesh mesh = geometry::makeIcosphere(3, 15);
    mesh.positions.rowwise() += Eigen::RowVector3d(30, 30, 30);
    return mesh;
  }();
  MosaicOptions options;
  options.tileHeight = 100;
  const Point onSphere(45, 30, 30), off(10, 12, 14);
  const SliceMosaic near = makeCloseUps(image, {{&sphere, "sphere", "#fff"}},
                                        {{onSphere, "here"}, {off, "there"}}, 20, options);
  ASSERT_EQ(near.rows.size(), 3u);
  ASSERT_EQ(near.outlines.size(), 2u) << "the ring is an outline, too";
  for (const auto& row : near.rows) {
    ASSERT_EQ(row.size(), 2u);
    for (const MosaicTile& tile : row) ASSERT_EQ(tile.paths.size(), 2u);
    EXPECT_TRUE(row[1].paths[0].empty()) << "nothing of the sphere is within 10 mm";
  }
  EXPECT_NE(near.rows[0][0].place.find("here"), std::string::npos);
  EXPECT_FALSE(near.rows[0][0].paths[0].empty());
  EXPECT_EQ(near.rows[0][0].paths[1].substr(0, 2), "M3") << "a ring about the middle of 100 pixels";
  EXPECT_THROW((void)makeCloseUps(image, {}, {}, 20, options), InvalidInput);
  EXPECT_THROW((void)makeCloseUps(image, {}, {{off, ""}}, 0, options), InvalidInput);
}

TEST(Mosaic, GreyLevelsAreThoseOfTheSubject) {
  // A brain of 100 in a shell of fat of 1000.
  Grid grid;
  grid.size = {20, 20, 20};
  Volume<float> head(grid, 1000.0F), brain(grid, 0.0F);
  for (std::size_t v = 0; v < head.size(); ++v) {
    const auto at = grid.subscripts(v);
    const bool inside = std::all_of(at.begin(), at.end(), [](int i) { return i > 4 && i < 15; });
    if (!inside) continue;
    head[v] = 100;
    brain[v] = 1;
  }
  MosaicOptions options;
  options.perRow = 1;
  const auto middleOf = [](const SliceMosaic& mosaic) {
    const Picture& picture = mosaic.rows[0][0].picture;
    return static_cast<int>(picture.pixel(picture.width / 2, picture.height / 2)[0]);
  };
  EXPECT_LT(middleOf(makeMosaic(head, std::vector<MosaicOutline>{}, options)), 60);
  options.subject = &brain;
  EXPECT_GT(middleOf(makeMosaic(head, std::vector<MosaicOutline>{}, options)), 200);
  EXPECT_GT(middleOf(makeMosaics(head, head, options)[0]), 200);
  const Volume<float> other;
  options.subject = &other;
  EXPECT_THROW(static_cast<void>(makeMosaic(head, std::vector<MosaicOutline>{}, options)),
               InvalidInput);
}

}  // namespace
}  // namespace explica::report
