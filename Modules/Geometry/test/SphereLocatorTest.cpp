// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/SphereLocator.h"

#include "Explica/Geometry/Fixtures.h"
#include "Explica/Testing/TimesCovered.h"

#include <gtest/gtest.h>

#include <random>

namespace explica::geometry {
namespace {

Vector pointOf(const TriangleMesh& mesh, const SpherePlace& place) {
  Vector sum = Vector::Zero();
  for (int k = 0; k < 3; ++k) sum += place.weights[k] * mesh.corner(place.face, k);
  return sum;
}

/// A sphere of uneven faces: vertices pushed together about one pole.
TriangleMesh unevenSphere() {
  TriangleMesh mesh = makeIcosphere(4, 100);
  mesh.positions.col(2).array() += 60;
  return mesh;
}

TEST(SphereLocator, WeightsGiveBackEveryDirection) {
  const SphereLocator locator(unevenSphere());
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::int32_t last = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vector x(normal(random), normal(random), normal(random));
    for (const SpherePlace& place : {locator.locate(x), locator.locate(x, last)}) {
      ASSERT_GE(place.weights.minCoeff(), 0);
      EXPECT_NEAR(place.weights.sum(), 1, 1e-14);
      EXPECT_LT(pointOf(locator.mesh(), place).normalized().cross(x.normalized()).norm(), 1e-13);
      EXPECT_GT(pointOf(locator.mesh(), place).dot(x), 0);
      last = place.face;
    }
  }
}

TEST(SphereLocator, VerticesAndEdgeMidpointsHaveAFace) {
  const TriangleMesh mesh = makeIcosphere(3);
  const SphereLocator locator(mesh);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const SpherePlace corner = locator.locate(mesh.corner(f, k));
      EXPECT_LT((pointOf(mesh, corner) - mesh.corner(f, k)).norm(), 1e-14);
      EXPECT_LE(corner.face, f);
      const Vector middle = (mesh.corner(f, k) + mesh.corner(f, (k + 1) % 3)) / 2;
      EXPECT_LT((pointOf(mesh, locator.locate(middle)) - middle).norm(), 1e-14);
    }
  }
}

TEST(SphereLocator, FindsAFaceOnFourFacesEachAQuarterOfTheSphere) {
  TriangleMesh tetrahedron;
  tetrahedron.positions.resize(4, 3);
  tetrahedron.positions << 1, 1, 1, -1, -1, 1, 1, -1, -1, -1, 1, -1;
  tetrahedron.faces.resize(4, 3);
  tetrahedron.faces << 0, 3, 1, 0, 1, 2, 0, 2, 3, 1, 3, 2;
  ASSERT_TRUE(turnedOver(tetrahedron).empty());
  ASSERT_EQ(testing::timesCovered(tetrahedron), 1);
  const SphereLocator locator(tetrahedron);
  for (const Vector& x :
       {Vector(1, 0, 0), Vector(0, -1, 0), Vector(-1, -1, -1), Vector(-1, 1, 1)}) {
    const Vector found = pointOf(tetrahedron, locator.locate(x));
    EXPECT_LT(found.normalized().cross(x.normalized()).norm(), 1e-14);
    EXPECT_GT(found.dot(x), 0);
  }
}

TEST(TurnedOver, FindsTheFacesOfAVertexBeyondItsRing) {
  TriangleMesh mesh = makeIcosphere(3);
  EXPECT_TRUE(turnedOver(mesh).empty());
  EXPECT_EQ(testing::timesCovered(mesh), 1);
  const Eigen::RowVector3d beyond =
      mesh.positions.row(mesh.faces(0, 1)) + mesh.positions.row(mesh.faces(0, 2));
  mesh.positions.row(mesh.faces(0, 0)) =
      (1.3 * beyond / 2 - 0.3 * mesh.positions.row(mesh.faces(0, 0))).eval();
  const auto turned = turnedOver(mesh);
  EXPECT_EQ(turned.size(), 1u);
  EXPECT_EQ(turned.front(), 0);
  mesh.faces.col(1).swap(mesh.faces.col(2));
  EXPECT_EQ(static_cast<Eigen::Index>(turnedOver(mesh).size()), mesh.faceCount() - 1);
  EXPECT_EQ(testing::timesCovered(mesh), -1);
}

TEST(SphericalOrientation, IsExactWhereDeterminantsRound) {
  const Point a(1, 1e-9, 0), b(1, 0, 1e-9);
  EXPECT_EQ(sphericalOrientation(a, b, a + b), 0);
  const Vector ulp(4.5e-16, 0, 0);  // a x b = (1e-18, -1e-9, -1e-9)
  EXPECT_EQ(sphericalOrientation(a, b, a + b + ulp), 1);
  EXPECT_EQ(sphericalOrientation(b, a, a + b + ulp), -1);
  EXPECT_EQ(sphericalOrientation(a, b, a + b - ulp), -1);
}

}  // namespace
}  // namespace explica::geometry
