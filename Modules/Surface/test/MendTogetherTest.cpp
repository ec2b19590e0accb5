// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/MendTogether.h"

#include "../src/MoveTogether.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace explica::surface {
namespace {

/// One shape in three sizes.
struct Nested {
  TriangleMesh inner, middle, outer;
  [[nodiscard]] std::array<TriangleMesh*, 3> all() { return {&inner, &middle, &outer}; }
};

Nested nested(const TriangleMesh& shape) {
  Nested made;
  double size = 1;
  for (TriangleMesh* mesh : made.all()) {
    *mesh = shape;
    for (Eigen::Index v = 0; v < shape.vertexCount(); ++v) {
      mesh->positions.row(v) = asStored(size * Point(shape.positions.row(v)));
    }
    size += 0.25;
  }
  return made;
}

double longestEdge(const TriangleMesh& mesh) {
  double longest = 0;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      longest = std::max(longest, (mesh.corner(f, k) - mesh.corner(f, (k + 1) % 3)).norm());
    }
  }
  return longest;
}

/// Known everywhere: the first coordinate and more.
Eigen::VectorXd valuesAt(const TriangleMesh& mesh) {
  return mesh.positions.col(0).array() + 20;
}

/// Sound spheres whose vertices still belong to each other; `values` are those of valuesAt().
void expectTogether(Nested& surfaces, const Eigen::VectorXd& values) {
  for (const TriangleMesh* mesh : surfaces.all()) {
    const auto condition = geometry::inspectMesh(*mesh);
    EXPECT_TRUE(condition.closedManifold());
    EXPECT_EQ(condition.eulerCharacteristic, 2);
    EXPECT_TRUE(geometry::findSelfIntersections(*mesh).empty());
    EXPECT_EQ(mesh->faces, surfaces.inner.faces);
  }
  EXPECT_LT((1.25 * surfaces.inner.positions - surfaces.middle.positions).norm(), 1e-4);
  EXPECT_LT((1.5 * surfaces.inner.positions - surfaces.outer.positions).norm(), 1e-4);
  ASSERT_EQ(values.size(), surfaces.inner.vertexCount());
  EXPECT_LT((values - valuesAt(surfaces.inner)).cwiseAbs().maxCoeff(), 1e-4);
}

TEST(MendTogether, SmallFacesGoFromAllSurfacesAndTheCountStays) {
  TriangleMesh shape = geometry::makeIcosphere(3, 10);
  // Vertices drawn close to a neighbour.
  for (const Eigen::Index f : {3, 400, 900}) {
    const int a = shape.faces(f, 0), b = shape.faces(f, 1);
    shape.positions.row(a) = 0.98 * shape.positions.row(b) + 0.02 * shape.positions.row(a);
  }
  Nested surfaces = nested(shape);
  Eigen::MatrixXd values = valuesAt(surfaces.inner);
  const MendingLimits limits{0.1, 10};
  ASSERT_LT(geometry::faceAreas(surfaces.inner).minCoeff(), limits.leastArea);
  const Mending done = mendTogether(surfaces.all(), values, limits, 1.5);
  EXPECT_GE(done.removed, 3);
  EXPECT_EQ(done.inserted, done.removed);
  EXPECT_EQ(surfaces.inner.faceCount(), shape.faceCount());
  EXPECT_GE(geometry::faceAreas(surfaces.inner).minCoeff(), limits.leastArea);
  expectTogether(surfaces, values);
}

TEST(MendTogether, EdgesTooLongInOneSurfaceAreSplitInAll) {
  Nested surfaces = nested(geometry::makeIcosphere(3, 10));
  Eigen::MatrixXd values = valuesAt(surfaces.inner);
  const double most = 0.97 * longestEdge(surfaces.outer);
  ASSERT_LT(longestEdge(surfaces.inner), most);
  const Mending done = mendTogether(surfaces.all(), values, {0.01, most}, 1.5);
  EXPECT_GT(done.inserted, 0);
  EXPECT_LE(longestEdge(surfaces.outer), most);
  expectTogether(surfaces, values);
}

TEST(MendTogether, AVertexBetweenOneThatIsNotKnownAndAnotherIsNotKnown) {
  Nested surfaces = nested(geometry::makeIcosphere(2, 10));
  Eigen::MatrixXd values = Eigen::VectorXd::Constant(surfaces.inner.vertexCount(), 3);
  values.topRows(40).setZero();
  mendTogether(surfaces.all(), values, {0.01, 0.9 * longestEdge(surfaces.outer)}, 3);
  ASSERT_GT(values.size(), 162);
  for (const double value : values.reshaped()) EXPECT_TRUE(value == 0 || value == 3) << value;
}

TEST(MendTogether, WhatIsSoundStaysToTheBit) {
  Nested surfaces = nested(geometry::makeIcosphere(3, 10));
  const Nested before = surfaces;
  Eigen::MatrixXd values = valuesAt(surfaces.inner);
  const Mending done = mendTogether(surfaces.all(), values, {0.01, 10}, 1.5);
  EXPECT_EQ(done.removed + done.inserted, 0);
  EXPECT_EQ(surfaces.outer.positions, before.outer.positions);
  EXPECT_EQ(surfaces.outer.faces, before.outer.faces);
}

}  // namespace
}  // namespace explica::surface
