// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/VisibleFraction.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Testing/DepthBuffer.h"
#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>

#include <numeric>

namespace explica::visibility {
namespace {

TEST(VisibleFraction, OfASphereIsTheCapTowardsTheViewpoint) {
  // The cap of points x with x . P > R^2 has the share (1 - R/D)/2 of the area.
  for (const double distance : {1.5, 4.0, 1000.0}) {
    const Point from = distance * Point(1, 2, 2) / 3;
    const VisibleFraction seen = visibleFraction(geometry::makeIcosphere(5), viewpoint(from));
    EXPECT_NEAR(seen.total, (1 - 1 / distance) / 2, 4e-3) << distance;
  }
}

TEST(VisibleFraction, OfASphereFarFromTheOriginIsTheSame) {
  const Point centre(800, -900, 700);
  const VisibleFraction seen =
      visibleFraction(geometry::makeIcosphere(4, 1.0, centre), viewpoint(centre + Point(0, 0, 4)));
  EXPECT_NEAR(seen.total, 0.375, 1e-2);
}

TEST(VisibleFraction, OfAPlateIsAllOrNothing) {
  const TriangleMesh plate = geometry::makeRectangle(7, 5, 2, 1);
  const VisibleFraction front = visibleFraction(plate, viewpoint(Point(1, 0.5, 3)));
  EXPECT_EQ(front.total, 1);
  EXPECT_EQ(front.vertex.minCoeff(), 1);
  EXPECT_EQ(visibleFraction(plate, viewpoint(Point(1, 0.5, -3))).total, 0);
}

TEST(VisibleFraction, BehindASmallerPlateIsItsShadow) {
  // Seen from height 2, the unit square at height 1 covers a 2 x 2 square of the 4 x 4 plate at 0.
  TriangleMesh floor = geometry::makeRectangle(40, 40, 4, 4);
  TriangleMesh lid = geometry::makeRectangle(1, 1, 1, 1);
  lid.positions.col(0).array() += 1.5;
  lid.positions.col(1).array() += 1.5;
  lid.positions.col(2).array() += 1;
  const TriangleMesh both = geometry::joined(floor, lid);
  const VisibleFraction seen = visibleFraction(both, viewpoint(Point(2, 2, 2)), {4});
  std::vector<std::int32_t> floorFaces;
  for (Eigen::Index f = 0; f < floor.faceCount(); ++f) {
    floorFaces.push_back(static_cast<std::int32_t>(f));
  }
  EXPECT_NEAR(seen.of(both, floorFaces), 0.75, 1e-2);
  EXPECT_NEAR(visibleFraction(floor, viewpoint(Point(2, 2, 2))).total, 1, 1e-12);
}

TEST(VisibleFraction, IsWhatADepthBufferShows) {
  // Pixels of 1/30 edge and 16 rays a face: both count the same thing to a few parts in a thousand.
  const std::vector<std::pair<std::string, TriangleMesh>> zoo = {
      {"sphere", geometry::makeIcosphere(4)},
      {"folded sphere", geometry::makeFoldedSphere(5, 1.0, 0.3, 8)},
      {"torus", geometry::makeTorus(80, 40, 1.0, 0.4)}};
  for (const auto& [name, mesh] : zoo) {
    std::vector<std::int32_t> faces(static_cast<std::size_t>(mesh.faceCount()));
    std::iota(faces.begin(), faces.end(), 0);
    for (const Point& eye : {Point(0.3, 0.4, 3), Point(-2, 1.5, 1), Point(400, -700, 300)}) {
      const VisibleFraction rays = visibleFraction(mesh, viewpoint(eye), {4});
      const testing::FacePixels pixels = testing::renderFaces(mesh, eye, 2000);
      // Faces that the picture resolves; those edge-on to the viewpoint have too few pixels.
      EXPECT_NEAR(rays.of(mesh, faces), testing::seenShare(mesh, faces, pixels), 4e-3)
          << name << " from " << eye.transpose();
      double differing = 0, resolved = 0;
      for (const std::int32_t f : faces) {
        if (pixels.covered[f] < 50) continue;
        resolved += 1;
        differing += std::abs(rays.face[f] - pixels.seen[f] / pixels.covered[f]) > 0.15;
      }
      EXPECT_GT(resolved, 0.7 * static_cast<double>(faces.size())) << name;
      EXPECT_LT(differing, 0.01 * resolved) << name << " from " << eye.transpose();
    }
  }
}

TEST(VisibleFraction, RemovingAnOccluderHidesNothing) {
  const TriangleMesh folded = geometry::makeFoldedSphere(3);
  TriangleMesh part = folded;
  part.faces.conservativeResize(folded.faceCount() * 3 / 4, 3);
  const Viewpoints from = viewpoint(Point(0.5, 1, 4));
  const VisibleFraction whole = visibleFraction(folded, from);
  const VisibleFraction less = visibleFraction(part, from);
  for (Eigen::Index f = 0; f < part.faceCount(); ++f) EXPECT_GE(less.face[f], whole.face[f]) << f;
}

TEST(SeenShare, OfFewFacesIsThatOfTheWholeSurface) {
  const TriangleMesh folded = geometry::makeFoldedSphere(5, 1.0, 0.3, 8);
  for (const Point& eye : {Point(0.3, 0.4, 3), Point(-2, 1.5, 1), Point(400, -700, 300)}) {
    const VisibleFraction all = visibleFraction(folded, viewpoint(eye));
    for (const Point& about : {Point(0, 0, 1), Point(-0.6, 0.5, 0.6), Point(0.5, -0.8, -0.3)}) {
      std::vector<std::int32_t> faces;
      for (Eigen::Index f = 0; f < folded.faceCount(); ++f) {
        if ((folded.corner(f, 0) - about).norm() < 0.5) faces.push_back(static_cast<int>(f));
      }
      ASSERT_GT(faces.size(), 100u);
      EXPECT_NEAR(seenShare(folded, faces, viewpoint(eye)), all.of(folded, faces), 1e-12)
          << eye.transpose() << " onto " << about.transpose();
    }
  }
}

TEST(SeenShare, WhatStandsFarAboveHidesToo) {
  TriangleMesh floor = geometry::makeRectangle(10, 10, 1, 1);
  TriangleMesh lid = geometry::makeRectangle(1, 1, 100, 100);  // no corner of it is near
  lid.positions.rowwise() += Eigen::RowVector3d(-50, -49.5, 30);
  const TriangleMesh both = geometry::joined(floor, lid);
  std::vector<std::int32_t> faces(200);
  std::iota(faces.begin(), faces.end(), 0);
  EXPECT_NEAR(seenShare(both, faces, viewpoint(Point(0.5, 0.5, 1e5))), 0, 1e-12);
  lid.positions.col(1).array() += 50;  // from the middle line on
  EXPECT_NEAR(seenShare(geometry::joined(floor, lid), faces, viewpoint(Point(0.5, 0.5, 1e5))), 0.5,
              0.01);
}

TEST(VisibleFraction, FromALineIsTheMeanOfItsPoints) {
  const TriangleMesh plate = geometry::makeRectangle(3, 3, 1, 1);
  const Viewpoints line = viewLine(Point(0.5, 0.5, -1), Point(0.5, 0.5, 1), 2);
  EXPECT_NEAR(visibleFraction(plate, line).total, 0.5, 1e-12);
}

TEST(VisibleFraction, AfterAMotionIsWhatTheWholeSurfaceShows) {
  const TriangleMesh folded = geometry::makeFoldedSphere(4);
  Positions moved = folded.positions;
  for (Eigen::Index v = 0; v < moved.rows(); ++v) {
    const Point x = moved.row(v).transpose();
    if (x.normalized().dot(Vector(1, 1, 1).normalized()) > 0.9) moved.row(v) *= 1.15;
  }
  const TriangleMesh mesh{moved, folded.faces};
  ASSERT_EQ(moved.colwise().maxCoeff(), folded.positions.colwise().maxCoeff());
  ASSERT_EQ(moved.colwise().minCoeff(), folded.positions.colwise().minCoeff());
  for (const Point& eye : {Point(4, 4, 4), Point(-4, -5, -4), Point(2, -1, 0.5), Point(0, 0, 0)}) {
    const VisibleFraction before = visibleFraction(folded, viewpoint(eye));
    const VisibleFraction whole = visibleFraction(mesh, viewpoint(eye));
    const VisibleFraction after =
        visibleFractionAfter(mesh, viewpoint(eye), folded.positions, before);
    EXPECT_EQ(after.face, whole.face);
    EXPECT_EQ(after.arriving, whole.arriving);
    EXPECT_EQ(after.vertex, whole.vertex);
    EXPECT_EQ(after.total, whole.total);
  }
}

TEST(VisibleFraction, AfterAMotionTheShadowHasMoved) {
  const TriangleMesh folded = geometry::makeFoldedSphere(4);
  const TriangleMesh before =
      geometry::joined(folded, geometry::makeIcosphere(2, 0.3, Point(3, 0, 0)));
  TriangleMesh mesh = before;
  mesh.positions.bottomRows(mesh.vertexCount() - folded.vertexCount()).col(1).array() += 0.4;
  for (const Point& eye : {Point(6, 0, 0), Point(50, 3, 1), Point(3.5, 0.1, 0)}) {
    const VisibleFraction then = visibleFraction(before, viewpoint(eye));
    const VisibleFraction whole = visibleFraction(mesh, viewpoint(eye));
    ASSERT_NE(whole.face.head(folded.faceCount()), then.face.head(folded.faceCount()));
    EXPECT_EQ(visibleFractionAfter(mesh, viewpoint(eye), before.positions, then).face, whole.face);
  }
}

TEST(VisibleFraction, DoesNotDependOnTheNumberOfThreads) {
  const TriangleMesh folded = geometry::makeFoldedSphere(4);
  setThreadCount(1);
  const VisibleFraction one = visibleFraction(folded, viewpoint(Point(0, 0, 4)));
  setThreadCount(4);
  const VisibleFraction four = visibleFraction(folded, viewpoint(Point(0, 0, 4)));
  setThreadCount(0);
  EXPECT_EQ(one.face, four.face);
  EXPECT_EQ(one.vertex, four.vertex);
}

TEST(StandingOver, IsTheShareOfAFaceAboveListedOnes) {
  // A unit square, far from the origin, and triangles above it, half above, beside and below.
  TriangleMesh mesh;
  mesh.positions.resize(16, 3);
  mesh.positions.topRows(4) << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  const std::array<Point, 4> at = {Point(0.2, 0.2, 1), Point(0.8, 0.3, 1), Point(2, 0.2, 1),
                                   Point(0.2, 0.2, -1)};
  mesh.faces.resize(6, 3);
  mesh.faces.topRows(2) << 0, 1, 2, 0, 2, 3;
  for (int t = 0; t < 4; ++t) {
    const Point corners[3] = {at[t], at[t] + Point(0.6, 0, 0), at[t] + Point(0, 0.6, 0)};
    for (int k = 0; k < 3; ++k) mesh.positions.row(4 + 3 * t + k) = corners[k].transpose();
    mesh.faces.row(2 + t) << 4 + 3 * t, 5 + 3 * t, 6 + 3 * t;
  }
  const Eigen::RowVector3d far(400, -300, 200);
  mesh.positions.rowwise() += far;
  const std::vector<std::int32_t> listed = {0, 1}, asked = {2, 3, 4, 5};
  const std::vector<float> over =
      standingOver(mesh.positions, mesh.faces, listed, asked, Vector::UnitZ());
  EXPECT_EQ(over[0], 1);
  EXPECT_FLOAT_EQ(over[1], 2.0F / 3);
  EXPECT_EQ(over[2], 0);
  EXPECT_EQ(over[3], 0) << "what lies below hides nothing";
  EXPECT_EQ(standingOver(mesh.positions, mesh.faces, listed, asked, -Vector::UnitZ())[3], 1);
  EXPECT_THROW(
      (void)standingOver(mesh.positions, mesh.faces, listed, asked, Vector::Constant(kNaN)),
      InvalidInput);
}

TEST(VisibleFraction, RefusesBadInput) {
  TriangleMesh sphere = geometry::makeIcosphere(0);
  EXPECT_THROW((void)visibleFraction(TriangleMesh{}, viewpoint(Point(0, 0, 1))), InvalidInput);
  EXPECT_THROW((void)visibleFraction(sphere, Viewpoints{}), InvalidInput);
  EXPECT_THROW((void)visibleFraction(sphere, viewpoint(Point(0, 0, 3)), {0}), InvalidInput);
  sphere.positions(3, 1) = kNaN;
  EXPECT_THROW((void)visibleFraction(sphere, viewpoint(Point(0, 0, 3))), InvalidInput);
}

}  // namespace
}  // namespace explica::visibility
