// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/Contour.h"

#include "Explica/Core/Errors.h"
#include "Explica/IO/VolumeFile.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <filesystem>

namespace explica::planar {
namespace {

Grid planeGrid(int size, const Vector& spacing) {
  Grid grid;
  grid.size = {size, size, 1};
  grid.spacing = spacing;
  return grid;
}

/// Label 2 within a ring about (cx, cy) in mm, label 1 inside it.
Volume<Label> ring(const Grid& grid, double cx, double cy, double inner, double outer) {
  Volume<Label> labels(grid, 0);
  for (int j = 0; j < grid.size[1]; ++j) {
    for (int i = 0; i < grid.size[0]; ++i) {
      const double r = std::hypot(i * grid.spacing.x() - cx, j * grid.spacing.y() - cy);
      labels(i, j, 0) = r < inner ? 1 : (r < outer ? 2 : 0);
    }
  }
  return labels;
}

TEST(Contour, OfADiscIsSubPixelWithAnisotropicSpacing) {
  const Volume<Label> labels = ring(planeGrid(64, {1, 0.7, 1}), 31.3, 22.1, 17.4, 17.4);
  const std::vector<Curve> contours = contoursOfLabel(labels, 1, 0);
  ASSERT_EQ(contours.size(), 1U);
  double worst = 0;
  double mean = 0;
  for (int v = 0; v < contours[0].vertexCount(); ++v) {
    const double error = (contours[0].point(v) - Point2(31.3, 22.1)).norm() - 17.4;
    worst = std::max(worst, std::abs(error));
    mean += error / contours[0].vertexCount();
  }
  EXPECT_LT(worst, 0.45);
  EXPECT_LT(std::abs(mean), 0.05);
  EXPECT_GT(signedArea(contours[0].positions), 0);
  EXPECT_TRUE(intersectingEdges(contours[0]).empty());
}

TEST(Contour, RingHasAnOuterContourAndAClockwiseHole) {
  const Volume<Label> labels = ring(planeGrid(64, {1, 1, 1}), 31.3, 30.4, 10, 18);
  const std::vector<Curve> contours = contoursOfLabel(labels, 2, 0);
  ASSERT_EQ(contours.size(), 2U);
  EXPECT_NEAR(signedArea(contours[0].positions), kPi * 18 * 18, 12);
  EXPECT_NEAR(signedArea(contours[1].positions), -kPi * 10 * 10, 8);
}

TEST(Contour, ClosesAtTheRimAndKeepsDiagonalPixelsApart) {
  Volume<Label> labels(planeGrid(4, {1, 1, 1}), 0);
  labels(0, 0, 0) = 5;
  labels(1, 1, 0) = 5;
  const std::vector<Curve> contours = contoursOfLabel(labels, 5, 0, {0.0});
  EXPECT_EQ(contours.size(), 2U);
  for (const Curve& c : contours) EXPECT_TRUE(intersectingEdges(c).empty());
}

TEST(Contour, LiesInTheWorldWhereTheSliceIs) {
  Grid grid = planeGrid(40, {1.3, 1.3, 8});
  grid.size[2] = 3;
  grid.direction = (Eigen::AngleAxisd(0.5, Vector(1, 2, -1).normalized()) *
                    Eigen::AngleAxisd(0.2, Vector::UnitZ()))
                       .toRotationMatrix();
  grid.direction.col(1) *= -1;  // as DICOM rows run
  grid.origin = {-40, 12, 77};
  Volume<Label> labels(grid, 0);
  for (int j = 0; j < 40; ++j) {
    for (int i = 0; i < 40; ++i) labels(i, j, 1) = std::hypot(i - 20.0, j - 18.0) < 9 ? 3 : 0;
  }
  EXPECT_EQ(largestSlice(labels, 3), 1);
  const Curve contour = contoursOfLabel(labels, 3, 1).front();
  const PlaneFrame frame = frameOfSlice(grid, 1);
  EXPECT_GT(signedArea(contour.positions), 0);
  const Point centre = grid.toWorld({20, 18, 1});
  for (int v = 0; v < contour.vertexCount(); ++v) {
    const Point world = frame.toWorld(contour.point(v));
    EXPECT_NEAR((world - centre).norm(), 9 * 1.3, 0.8);
    EXPECT_NEAR(grid.toIndex(world).z(), 1, 1e-9);
  }
}

TEST(Contour, CoordinatesOfAnAxialSliceAreRas) {
  Grid grid = planeGrid(10, {2, 2, 2});
  grid.origin = {-7, 5, 30};
  grid.direction.col(0) = -Vector::UnitX();  // stored right to left
  const PlaneFrame frame = frameOfSlice(grid, 0);
  const Point world = grid.toWorld({3, 4, 0});
  EXPECT_LT((frame.toPlane(world) - Point2(world.x(), world.y())).norm(), 1e-12);
}

TEST(Contour, AbsentLabelSaysWhereItIs) {
  Grid grid = planeGrid(8, {1, 1, 1});
  grid.size[2] = 4;
  Volume<Label> labels(grid, 0);
  labels(3, 3, 2) = 9;
  try {
    (void)contoursOfLabel(labels, 9, 0);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("slice 2"), std::string::npos);
  }
  EXPECT_THROW((void)contoursOfLabel(labels, 9, 4), InvalidInput);
}

TEST(Contour, ResampledKeepsTheShape) {
  Curve square;
  square.positions.resize(4, 2);
  square.positions << 0, 0, 4, 0, 4, 4, 0, 4;
  const Curve fine = resampled(square, 64);
  EXPECT_NEAR(signedArea(fine.positions), 16, 1e-12);
  EXPECT_NEAR(edgeLengths(fine).maxCoeff(), 0.25, 1e-12);
}

TEST(Contour, OfARealMyocardiumIsARingOfItsThickness) {
  const std::filesystem::path file =
      std::filesystem::path(EXPLICA_REAL_DATA) / "lv_sunnybrook_SCD0000101" / "ED_label.nii.gz";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "skipped: no real data";
  const Volume<Label> labels = io::readLabels(file).volume;
  const std::vector<Curve> contours = contoursOfLabel(labels, 2, 4);
  ASSERT_EQ(contours.size(), 2U);
  const double outer = std::sqrt(signedArea(contours[0].positions) / kPi);
  const double inner = std::sqrt(-signedArea(contours[1].positions) / kPi);
  EXPECT_NEAR(outer - inner, 6.55, 0.15);  // area-equivalent wall of slice 4, mm
  for (const Curve& c : contours) EXPECT_TRUE(intersectingEdges(c).empty());
}

}  // namespace
}  // namespace explica::planar
