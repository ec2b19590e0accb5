// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Region.h"

#include "Meander.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Testing/Meshes.h"
#include "Explica/Unfolding/Distortion.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>

namespace explica::unfolding {
namespace {

std::int32_t nearestVertex(const TriangleMesh& mesh, const Point& place) {
  Eigen::Index nearest = 0;
  (void)(mesh.positions.rowwise() - place.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  return static_cast<std::int32_t>(nearest);
}

TEST(Region, EuclideanBallIsConnectedToItsCentre) {
  // Banks of a fold come within the radius of each other without being joined inside the ball.
  const TriangleMesh sheet = makeMeander(96, 8, 2.1, 2);
  RegionOptions options;
  options.center = sheet.positions.row(nearestVertex(sheet, Point(3, 4, 8))).transpose();
  options.radius = 5;
  const Region region = selectRegion(sheet, options);
  EXPECT_EQ(region.pieces, 1);
  EXPECT_EQ(region.holes, 0);
  for (const std::int32_t v : region.vertices) {
    EXPECT_LE((sheet.positions.row(v).transpose() - *options.center).norm(), 5);
  }
  EXPECT_TRUE(std::binary_search(region.vertices.begin(), region.vertices.end(), region.centre));
}

TEST(Region, GeodesicBallIsSmallerThanTheEuclideanOne) {
  const TriangleMesh sheet = makeMeander(96, 24);
  RegionOptions options;
  options.center =
      Eigen::Vector3d(sheet.positions.col(0).mean(), 12, sheet.positions.col(2).mean());
  options.radius = 12;
  const auto straight = selectRegion(sheet, options).faces.size();
  options.metric = RegionMetric::Geodesic;
  const auto along = selectRegion(sheet, options).faces.size();
  EXPECT_LT(along, straight);
  EXPECT_GT(along, straight / 10);
}

TEST(Region, ConeHoldsWhatLiesWithinItsAngle) {
  const TriangleMesh sphere = geometry::makeIcosphere(4, 10);
  const auto view = visibility::viewpoint(Point(0, 0, 100));
  RegionOptions options;
  options.center = Eigen::Vector3d(0, 0, 10);
  options.radius = 15;
  options.cone = 3;
  const Region region = selectRegion(sphere, options, &view);
  const double reach = 90 * std::tan(3 * kPi / 180);
  for (const std::int32_t v : region.vertices) {
    EXPECT_GT(sphere.positions(v, 2), 0);
    EXPECT_LT(sphere.positions.row(v).head<2>().norm(), 1.1 * reach);
  }
}

TEST(Region, HolesAndPiecesAreCounted) {
  const TriangleMesh sheet = geometry::makeRectangle(20, 20, 20, 20);
  std::vector<bool> ring(static_cast<std::size_t>(sheet.vertexCount()));
  for (Eigen::Index v = 0; v < sheet.vertexCount(); ++v) {
    const double r = (sheet.positions.row(v) - Eigen::RowVector3d(10, 10, 0)).norm();
    ring[v] = (r > 3.5 && r < 8) || sheet.positions.row(v).head<2>().sum() < 3;
  }
  const Region region = regionOfMarked(sheet, ring);
  EXPECT_EQ(region.pieces, 2);
  EXPECT_EQ(region.holes, 1);
}

TEST(Region, RefusesNothingEverythingAndNonsense) {
  const TriangleMesh sphere = geometry::makeIcosphere(2, 10);
  RegionOptions options;
  EXPECT_THROW((void)selectRegion(sphere, options), InvalidInput);
  options.vertex = 100000;
  EXPECT_THROW((void)selectRegion(sphere, options), InvalidInput);
  options.vertex = 3;
  options.radius = -1;
  EXPECT_THROW((void)selectRegion(sphere, options), InvalidInput);
  options.radius = 100;
  EXPECT_THROW((void)selectRegion(sphere, options), InvalidInput);
  options.radius = 1e-3;
  EXPECT_THROW((void)selectRegion(sphere, options), InvalidInput);
  EXPECT_THROW((void)regionOfMarked(sphere, std::vector<bool>(7, true)), InvalidInput);
}

TEST(Region, ViewpointsInsideOrOnTheSurfaceAreRefused) {
  const TriangleMesh sphere = geometry::makeIcosphere(3, 10);
  EXPECT_THROW(requireViewFromOutside(sphere, visibility::viewpoint(Point(1, 2, 3))), InvalidInput);
  EXPECT_THROW(requireViewFromOutside(sphere, visibility::viewpoint(sphere.corner(5, 0))),
               InvalidInput);
  EXPECT_NO_THROW(requireViewFromOutside(sphere, visibility::viewpoint(Point(0, 0, 30))));
}

TEST(Distortion, IsZeroForRigidMotionAndExactForAStretch) {
  const TriangleMesh sheet = geometry::makeRectangle(8, 8, 8, 8);
  std::vector<std::int32_t> faces(static_cast<std::size_t>(sheet.faceCount()));
  std::iota(faces.begin(), faces.end(), 0);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Vector(1, 2, 3).normalized()).toRotationMatrix();
  const Distortion rigid = measureDistortion(
      sheet, (sheet.positions * turn).rowwise() + Eigen::RowVector3d(3, 4, 5), faces);
  EXPECT_LT(rigid.areaErrorMax, 1e-12);
  EXPECT_LT(rigid.edgeStrainP95, 1e-12);
  EXPECT_LT(rigid.angleErrorMeanRad, 1e-7);
  const Distortion doubled = measureDistortion(sheet, 2 * sheet.positions, faces);
  EXPECT_NEAR(doubled.areaErrorMean, 3, 1e-12);
  EXPECT_NEAR(doubled.edgeStrainMean, 1, 1e-12);
  EXPECT_LT(doubled.angleErrorMeanRad, 1e-7);
}

}  // namespace
}  // namespace explica::unfolding
