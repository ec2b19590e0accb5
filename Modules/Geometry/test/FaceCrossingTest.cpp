// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/FaceCrossing.h"

#include <gtest/gtest.h>

namespace explica::geometry {
namespace {

TEST(FaceCrossing, OfAStandingTriangleThroughALyingOneIsTheSegmentBetweenItsEdges) {
  TriangleMesh mesh;
  mesh.positions.resize(6, 3);
  mesh.positions << -5, -5, 0, 5, -5, 0, 0, 5, 0,  // in z = 0
      -1, 0, -1, 1, 0, -1, 0, 0, 1;                // cuts it from (-1/2, 0, 0) to (1/2, 0, 0)
  mesh.faces.resize(2, 3);
  mesh.faces << 0, 1, 2, 3, 4, 5;
  const auto segment = crossingSegment(mesh, {0, 1});
  ASSERT_TRUE(segment);
  EXPECT_NEAR(((*segment)[0].point - (*segment)[1].point).norm(), 1, 1e-14);
  for (const CrossingEnd& end : *segment) {
    EXPECT_NEAR(std::abs(end.point.x()), 0.5, 1e-14);
    Point onEdge = Point::Zero(), onFace = Point::Zero();
    for (int k = 0; k < 2; ++k) {
      onEdge += end.edgeWeights[k] * mesh.positions.row(end.edge[k]).transpose();
    }
    for (int k = 0; k < 3; ++k) {
      onFace += end.faceWeights[k] * mesh.positions.row(end.face[k]).transpose();
    }
    EXPECT_LT((onEdge - end.point).norm(), 1e-14);
    EXPECT_LT((onFace - end.point).norm(), 1e-14);
  }
  EXPECT_LT(placeOfCrossing(mesh, {0, 1}).norm(), 1e-14);
}

TEST(FaceCrossing, OfFacesWithACommonVertexStartsThere) {
  TriangleMesh mesh;
  mesh.positions.resize(5, 3);
  mesh.positions << 0, 0, 0, 4, -2, 0, 4, 2, 0, 3, 0, -1, 3, 0, 1;
  mesh.faces.resize(2, 3);
  mesh.faces << 0, 1, 2, 0, 3, 4;
  const auto segment = crossingSegment(mesh, {0, 1});
  ASSERT_TRUE(segment);
  EXPECT_EQ((*segment)[0].edge[0], (*segment)[0].edge[1]);
  EXPECT_LT(((*segment)[1].point - Point(3, 0, 0)).norm(), 1e-14);
}

TEST(FaceCrossing, InOnePlaneHasNoSegmentButAPlace) {
  TriangleMesh mesh;
  mesh.positions.resize(6, 3);
  mesh.positions << 0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, 0, 5, 1, 0, 1, 5, 0;
  mesh.faces.resize(2, 3);
  mesh.faces << 0, 1, 2, 3, 4, 5;
  EXPECT_FALSE(crossingSegment(mesh, {0, 1}));
  EXPECT_TRUE(placeOfCrossing(mesh, {0, 1}).allFinite());
}

}  // namespace
}  // namespace explica::geometry
