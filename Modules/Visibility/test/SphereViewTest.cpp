// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/SphereView.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>

namespace explica::visibility {
namespace {

/// A closed surface of revolution about z through the profile's points (radius, height); the first
/// and last lie on the axis.
TriangleMesh revolved(const std::vector<Eigen::Vector2d>& profile, int around) {
  const auto rings = static_cast<int>(profile.size()) - 2;
  TriangleMesh mesh{Positions(rings * around + 2, 3), Faces(2 * rings * around, 3)};
  const int top = rings * around, bottom = top + 1;
  mesh.positions.row(top) << 0, 0, profile.front()[1];
  mesh.positions.row(bottom) << 0, 0, profile.back()[1];
  int f = 0;
  for (int r = 0; r < rings; ++r) {
    for (int k = 0; k < around; ++k) {
      const double t = 2 * kPi * k / around;
      const Eigen::Vector2d p = profile[static_cast<std::size_t>(r) + 1];
      mesh.positions.row(r * around + k) << p[0] * std::cos(t), p[0] * std::sin(t), p[1];
      const int next = (k + 1) % around;
      if (r == 0) mesh.faces.row(f++) << top, k, next;
      if (r + 1 == rings) {
        mesh.faces.row(f++) << bottom, r * around + next, r * around + k;
        continue;
      }
      mesh.faces.row(f++) << r * around + k, (r + 1) * around + k, (r + 1) * around + next;
      mesh.faces.row(f++) << r * around + k, (r + 1) * around + next, r * around + next;
    }
  }
  return mesh;
}

/// A half spherical bowl, open to +z: outer radius a, inner radius b.
TriangleMesh bowl(double a, double b, int steps) {
  std::vector<Eigen::Vector2d> profile;
  for (int n = 0; n <= steps; ++n) {  // from the bottom of the inside up to its edge
    const double t = kPi / 2 * n / steps;
    profile.emplace_back(b * std::sin(t), -b * std::cos(t));
  }
  for (int n = steps; n >= 0; --n) {  // from the outer edge down
    const double t = kPi / 2 * n / steps;
    profile.emplace_back(a * std::sin(t), -a * std::cos(t));
  }
  return revolved(profile, 4 * steps);
}

TEST(SphereView, OfAConvexSurfaceIsWhole) {
  TriangleMesh mesh = geometry::makeIcosphere(3, 20);
  mesh.positions.col(0) *= 2;
  const SphereView view = lookFromSphere(mesh, enclosingSphere(mesh, 64));
  // A ray that grazes a face may meet its neighbour, in single precision.
  EXPECT_NEAR(view.visibility, 1, 1e-4);
  EXPECT_EQ(view.seenShare, 1);
  EXPECT_GT(view.share.minCoeff(), 0.99);
}

TEST(SphereView, DirectionOfAnOpenFaceIsItsNormal) {
  const TriangleMesh mesh = geometry::makeIcosphere(2, 1);
  const auto far = viewSphere(Point::Zero(), 1000, 4000);
  const SphereView view = lookFromSphere(mesh, far);
  const Positions normals = geometry::faceNormalVectors(mesh).rowwise().normalized();
  EXPECT_LT((view.direction - normals).rowwise().norm().maxCoeff(), 0.02);
}

// From inside a hemisphere half of the flux through its opening gets out: the view factor from it
// to the disc across its rim is the ratio of their areas.
TEST(SphereView, OfABowlIsWhatViewFactorsSay) {
  constexpr double a = 12, b = 10;
  const TriangleMesh mesh = bowl(a, b, 24);
  ASSERT_GT(geometry::enclosedVolume(mesh), 0);
  ASSERT_TRUE(geometry::inspectMesh(mesh).closedManifold());
  const SphereView view = lookFromSphere(mesh, viewSphere(Point::Zero(), 1000, 1000));
  const double inside = 2 * kPi * b * b;
  const double rest = 2 * kPi * a * a + kPi * (a * a - b * b);
  EXPECT_NEAR(view.visibility, (inside / 2 + rest) / (inside + rest), 0.004);
  EXPECT_EQ(view.seenShare, 1);
}

TEST(SphereView, TurnsWithTheSurface) {
  const TriangleMesh mesh = geometry::makeFoldedSphere(3, 20.0, 0.4, 7);
  Viewpoints sphere = enclosingSphere(mesh, 64);
  const SphereView view = lookFromSphere(mesh, sphere);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Vector(0.2, -0.5, 0.8).normalized()).toRotationMatrix();
  TriangleMesh turned = mesh;
  turned.positions = mesh.positions * turn.transpose();
  for (Point& p : sphere.points) p = turn * p;
  const SphereView after = lookFromSphere(turned, sphere);
  EXPECT_NEAR(after.visibility, view.visibility, 2e-3);
  const double turnedBy =
      (after.direction - view.direction * turn.transpose()).rowwise().norm().mean();
  EXPECT_LT(turnedBy, 2e-3);
}

TEST(SphereView, RefusesWhatItCannotLookAt) {
  const TriangleMesh mesh = geometry::makeIcosphere(1, 1);
  EXPECT_THROW((void)lookFromSphere(mesh, {}), InvalidInput);
  EXPECT_THROW((void)lookFromSphere({}, viewSphere(Point::Zero(), 3, 12)), InvalidInput);
  EXPECT_THROW((void)viewSphere(Point::Zero(), 3, 0), InvalidInput);
  EXPECT_THROW((void)viewSphere(Point::Zero(), -1, 12), InvalidInput);
  TriangleMesh broken = mesh;
  broken.positions(0, 0) = kNaN;
  EXPECT_THROW((void)lookFromSphere(broken, viewSphere(Point::Zero(), 3, 12)), InvalidInput);
}

}  // namespace
}  // namespace explica::visibility
