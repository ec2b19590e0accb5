// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/SurfacePicture.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Report/SlicePicture.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>

namespace explica::report {
namespace {

SurfacePictureOptions small() {
  SurfacePictureOptions options;
  options.width = 200;
  options.height = 160;
  return options;
}

bool isWhite(const Picture& p, int x, int y) {
  return p.pixel(x, y)[0] == 255 && p.pixel(x, y)[1] == 255 && p.pixel(x, y)[2] == 255;
}

TEST(SurfacePicture, ARegionsColourEndsAtTheEdgesOfItsFaces) {
  // Two squares side by side, each of two faces; the vertices of the left one are the region.
  TriangleMesh mesh;
  mesh.positions.resize(6, 3);
  mesh.positions << 0, 0, 0, 0, 0, 10, 0, 10, 0, 0, 10, 10, 0, 20, 0, 0, 20, 10;
  mesh.faces.resize(4, 3);
  mesh.faces << 0, 2, 1, 1, 2, 3, 2, 4, 3, 3, 4, 5;
  const std::vector<Colour> colours = {{1, 0, 0}, {1, 0, 0}, {1, 0, 0},
                                       {1, 0, 0}, {0, 0, 1}, {0, 0, 1}};
  const std::vector<std::int32_t> keys = {1, 1, 1, 1, 0, 0};
  SurfacePictureOptions options;
  options.width = 80;
  options.height = 60;
  options.occlusion = 0;
  options.samples = 1;
  const Camera camera = cameraTowards(mesh.positions, Vector(-1, 0, 0), Vector(0, 0, 1),
                                      options.width, options.height);
  const SurfaceScene scene(mesh);
  for (const Filling filling : {Filling::Smooth, Filling::Discrete}) {
    const Picture picture = scene.render(camera, colours, filling, options, keys);
    int red = 0, blue = 0, mixed = 0;
    for (int x = 0; x < options.width; ++x) {
      const std::uint8_t* p = picture.pixel(x, options.height / 2 + 1);
      if (p[0] == 255 && p[1] == 255 && p[2] == 255) continue;
      red += p[0] > 0 && p[2] == 0;
      blue += p[2] > 0 && p[0] == 0;
      mixed += p[0] > 0 && p[2] > 0;
    }
    EXPECT_EQ(mixed, 0);
    EXPECT_NEAR(red, blue, 2) << "each has its square, none half a face of the other's";
    EXPECT_GT(red, 20);
  }
}

TEST(SurfacePicture, SphereFillsItsDisc) {
  const TriangleMesh sphere = geometry::makeIcosphere(4, 50);
  const SurfaceScene scene(sphere);
  const Picture p = scene.render(cameraFor(sphere.positions, ViewName::Left, 200, 160), {},
                                 Filling::Smooth, small());
  int covered = 0;
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 200; ++x) covered += !isWhite(p, x, y);
  }
  const double radius = 80 / 1.04;
  EXPECT_NEAR(covered, kPi * radius * radius, 0.03 * kPi * radius * radius);
}

TEST(SurfacePicture, ViewsShowTheSidesTheyAreNamedAfter) {
  TriangleMesh sphere = geometry::makeIcosphere(3, 50);
  std::vector<Colour> colours(sphere.vertexCount());
  for (Eigen::Index v = 0; v < sphere.vertexCount(); ++v) {
    colours[v] = sphere.positions(v, 0) < 0 ? Colour{1, 0, 0} : Colour{0, 0, 1};
  }
  const SurfaceScene scene(sphere);
  const auto middle = [&](ViewName view) {
    const Picture p = scene.render(cameraFor(sphere.positions, view, 200, 160), colours,
                                   Filling::Smooth, small());
    return std::array<int, 2>{p.pixel(100, 80)[0], p.pixel(100, 80)[2]};
  };
  EXPECT_GT(middle(ViewName::Left)[0], middle(ViewName::Left)[1]);
  EXPECT_GT(middle(ViewName::Right)[1], middle(ViewName::Right)[0]);
  // From the front, the patient's right is on the picture's left.
  const Picture front = scene.render(cameraFor(sphere.positions, ViewName::Front, 200, 160),
                                     colours, Filling::Smooth, small());
  EXPECT_GT(front.pixel(70, 80)[2], front.pixel(70, 80)[0]);
  // From above with the nose up, the patient's left is on the left.
  const Picture top = scene.render(cameraFor(sphere.positions, ViewName::Top, 200, 160), colours,
                                   Filling::Smooth, small());
  EXPECT_GT(top.pixel(70, 80)[0], top.pixel(70, 80)[2]);
}

TEST(SurfacePicture, FoldsAreDarkerThanCrowns) {
  const TriangleMesh folded = geometry::makeFoldedSphere(5, 50, 0.25, 6);
  const SurfaceScene scene(folded);
  const Eigen::VectorXd radius = folded.positions.rowwise().norm();
  const double middle = 0.5 * (radius.minCoeff() + radius.maxCoeff());
  double low = 0;
  double high = 0;
  int lows = 0;
  int highs = 0;
  for (Eigen::Index v = 0; v < radius.size(); ++v) {
    if (radius[v] < middle) {
      low += scene.openness()[v];
      ++lows;
    } else {
      high += scene.openness()[v];
      ++highs;
    }
  }
  EXPECT_LT(low / lows + 0.01, high / highs);
}

TEST(SurfacePicture, WhatHasMovedIsDrawnAsASurfaceByItself) {
  const TriangleMesh folded = geometry::makeFoldedSphere(5, 50, 0.25, 6);
  TriangleMesh moved = folded;
  std::vector<std::uint8_t> moves(static_cast<std::size_t>(folded.vertexCount()), 0);
  for (Eigen::Index v = 0; v < moved.vertexCount(); ++v) {
    if (moved.positions.row(v).minCoeff() <= 15) continue;
    moved.positions.row(v) *= 0.8;
    moves[v] = 1;
  }
  SurfaceScene scene(folded, moves);
  const SurfaceScene first(folded), fresh(moved);
  const Camera camera = cameraFor(folded.positions, ViewName::Top, 200, 160);
  const auto picture = [&](const SurfaceScene& of) {
    return of.render(camera, {}, Filling::Smooth, small(), {moves.begin(), moves.end()}).rgb;
  };
  EXPECT_EQ(scene.openness(), first.openness());
  EXPECT_EQ(picture(scene), picture(first));
  scene.moveTo(moved);
  EXPECT_EQ(scene.openness(), fresh.openness());
  EXPECT_EQ(picture(scene), picture(fresh));
  scene.moveTo(folded);
  EXPECT_EQ(scene.openness(), first.openness()) << "nothing of the way is left";
  EXPECT_THROW(SurfaceScene(folded).moveTo(moved), InvalidInput) << "all were to stay";
  EXPECT_THROW(scene.moveTo(geometry::makeIcosphere(5, 50)), InvalidInput) << "other places, too";
  moved.faces.row(0).reverseInPlace();
  EXPECT_THROW(scene.moveTo(moved), InvalidInput);
}

TEST(SurfacePicture, DoesNotDependOnThreads) {
  const TriangleMesh folded = geometry::makeFoldedSphere(4, 50, 0.25, 6);
  const auto picture = [&](int threads) {
    setThreadCount(threads);
    const SurfaceScene scene(folded);
    const Picture p = scene.render(cameraFor(folded.positions, ViewName::Top, 200, 160), {},
                                   Filling::Smooth, small());
    setThreadCount(0);
    return p.rgb;
  };
  EXPECT_EQ(picture(1), picture(4));
}

TEST(SurfacePicture, RefusesColoursOfAnotherSurface) {
  const TriangleMesh sphere = geometry::makeIcosphere(1);
  const SurfaceScene scene(sphere);
  EXPECT_THROW((void)scene.render(cameraFor(sphere.positions, ViewName::Left, 10, 10),
                                  std::vector<Colour>(3)),
               InvalidInput);
  EXPECT_THROW(SurfaceScene(TriangleMesh{}), InvalidInput);
}

TEST(SlicePicture, ContourLiesOnTheEdgeOfWhatItOutlines) {
  // An oblique, anisotropic grid holding a ball: the ball's contour must hide its edge everywhere.
  Grid grid;
  grid.size = {90, 70, 60};
  grid.spacing = Vector(0.9, 1.1, 1.4);
  grid.direction = Eigen::AngleAxisd(0.4, Vector(1, 2, 3).normalized()).toRotationMatrix();
  grid.origin = -grid.direction * grid.spacing.cwiseProduct(Vector(45, 35, 30));
  Volume<float> ball(grid, 0.0f);
  for (std::size_t v = 0; v < ball.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    ball[v] = static_cast<float>(std::clamp(20.5 - grid.toWorld(Vector(i, j, k)).norm(), 0.0, 1.0));
  }
  const TriangleMesh sphere = geometry::makeIcosphere(5, 20);
  for (const SliceAxis axis : {SliceAxis::Sagittal, SliceAxis::Coronal, SliceAxis::Axial}) {
    const SliceFrame frame = frameAround(axis, 5, Point::Constant(-24), Point::Constant(24), 240);
    const ColourScale grey{ColourMap::Grey, 0, 1, "", ""};
    const Picture plain = renderSlice(ball, frame, grey);
    const Picture lined = renderSlice(ball, frame, grey, {{&sphere, {1, 0, 0}, 2}});
    const double radius = std::sqrt(20.0 * 20 - 25) / frame.pixel;
    int wrong = 0;
    int red = 0;
    for (int y = 0; y < frame.height; ++y) {
      for (int x = 0; x < frame.width; ++x) {
        const double r = std::hypot(x + 0.5 - 0.5 * frame.width, y + 0.5 - 0.5 * frame.height);
        if (r < radius - 8 && plain.pixel(x, y)[1] < 250) ++wrong;
        if (r > radius + 8 && plain.pixel(x, y)[1] > 5) ++wrong;
        if (lined.pixel(x, y)[0] > 200 && lined.pixel(x, y)[1] < 60) {
          ++red;
          if (std::abs(r - radius) > 2) ++wrong;
        }
      }
    }
    EXPECT_EQ(wrong, 0);
    EXPECT_GT(red, 2 * radius);
  }
}

TEST(SurfacePicture, ADarkLineRunsBetweenKeys) {
  const TriangleMesh sphere = geometry::makeIcosphere(4, 30);
  const SurfaceScene scene(sphere);
  std::vector<std::int32_t> keys;
  for (Eigen::Index v = 0; v < sphere.vertexCount(); ++v) {
    keys.push_back(sphere.positions(v, 2) > 0 ? 1 : 0);
  }
  const Camera camera = cameraFor(sphere.positions, ViewName::Left, 200, 160);
  const Picture plain = scene.render(camera, {}, Filling::Smooth, small());
  const Picture lined = scene.render(camera, {}, Filling::Smooth, small(), keys);
  int darker = 0, rows = 0;
  for (int y = 0; y < 160; ++y) {
    int inRow = 0;
    for (int x = 0; x < 200; ++x) inRow += lined.pixel(x, y)[0] + 40 < plain.pixel(x, y)[0];
    darker += inRow;
    rows += inRow > 0;
  }
  EXPECT_GT(darker, 100) << "across the sphere";
  EXPECT_LT(rows, 16) << "about its equator only";
  EXPECT_THROW((void)scene.render(camera, {}, Filling::Smooth, small(), {1, 2}), InvalidInput);
}

}  // namespace
}  // namespace explica::report
