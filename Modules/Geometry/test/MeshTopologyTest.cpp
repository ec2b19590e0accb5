// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/MeshTopology.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Testing/Meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace explica::geometry {
namespace {

TEST(MeshTopology, EveryEdgeOfAClosedSurfaceJoinsTwoFacesThatNameIt) {
  const TriangleMesh mesh = makeTorus(12, 9, 2, 0.5);
  const MeshTopology t = buildTopology(mesh.faces, mesh.vertexCount());
  ASSERT_EQ(t.edges.rows(), 3 * mesh.faceCount() / 2);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto e = t.faceEdges(f, k);
      const int a = mesh.faces(f, k), b = mesh.faces(f, (k + 1) % 3);
      EXPECT_EQ(t.edges(e, 0), std::min(a, b));
      EXPECT_EQ(t.edges(e, 1), std::max(a, b));
      EXPECT_TRUE(t.edgeFaces(e, 0) == f || t.edgeFaces(e, 1) == f);
    }
  }
}

TEST(MeshTopology, VertexListsAreMutual) {
  const TriangleMesh mesh = makeIcosphere(2);
  const MeshTopology t = buildTopology(mesh.faces, mesh.vertexCount());
  for (std::int32_t v = 0; v < mesh.vertexCount(); ++v) {
    EXPECT_EQ(t.vertexFaces[v].size(), t.vertexVertices[v].size());  // closed: one face a neighbour
    for (const std::int32_t n : t.vertexVertices[v]) {
      const auto back = t.vertexVertices[n];
      EXPECT_NE(std::find(back.begin(), back.end(), v), back.end());
    }
  }
}

TEST(InspectMesh, KnowsSpheresToriAndRectangles) {
  const MeshCondition sphere = inspectMesh(makeIcosphere(2));
  EXPECT_TRUE(sphere.closedManifold());
  EXPECT_EQ(sphere.eulerCharacteristic, 2);
  EXPECT_EQ(sphere.components, 1);
  EXPECT_EQ(inspectMesh(makeTorus(10, 8, 2, 0.5)).eulerCharacteristic, 0);
  const MeshCondition sheet = inspectMesh(makeRectangle(3, 2, 1, 1));
  EXPECT_TRUE(sheet.manifold());
  EXPECT_FALSE(sheet.closedManifold());
  EXPECT_EQ(sheet.boundaryEdges, 10);
  EXPECT_EQ(sheet.eulerCharacteristic, 1);
}

TEST(InspectMesh, CountsEachDefect) {
  const TriangleMesh sphere = makeIcosphere(1);
  const auto last = sphere.faceCount();
  const auto with = [&](const Eigen::RowVector3i& face) {
    TriangleMesh mesh = sphere;
    mesh.faces.conservativeResize(last + 1, 3);
    mesh.faces.row(last) = face;
    return inspectMesh(mesh);
  };
  EXPECT_EQ(with({0, 0, 1}).repeatedVertexFaces, 1);
  EXPECT_EQ(with({0, 1, 999}).indicesOutOfRange, 1);
  EXPECT_EQ(with(sphere.faces.row(3)).duplicateFaces, 1);
  EXPECT_EQ(with(sphere.faces.row(3)).nonManifoldEdges, 3);

  TriangleMesh turned = sphere;
  std::swap(turned.faces(5, 0), turned.faces(5, 1));
  EXPECT_EQ(inspectMesh(turned).inconsistentEdges, 3);

  TriangleMesh infinite = sphere;
  infinite.positions(4, 1) = kNaN;
  EXPECT_EQ(inspectMesh(infinite).nonFiniteVertices, 1);

  TriangleMesh twin = sphere;
  twin.positions.row(7) = twin.positions.row(8);
  EXPECT_EQ(inspectMesh(twin).coincidentVertices, 1);
}

TEST(InspectMesh, TwoSpheresThatShareAVertexAreNotManifold) {
  TriangleMesh mesh = makeIcosphere(1);
  const auto vertices = mesh.vertexCount();
  const auto faces = mesh.faceCount();
  const TriangleMesh second = makeIcosphere(1, 1.0, {5, 0, 0});
  mesh.positions.conservativeResize(2 * vertices, 3);
  mesh.positions.bottomRows(vertices) = second.positions;
  mesh.faces.conservativeResize(2 * faces, 3);
  mesh.faces.bottomRows(faces) = second.faces.array() + static_cast<int>(vertices);
  EXPECT_EQ(inspectMesh(mesh).components, 2);
  EXPECT_EQ(inspectMesh(mesh).nonManifoldVertices, 0);
  for (Eigen::Index f = faces; f < 2 * faces; ++f) {
    for (int k = 0; k < 3; ++k) {
      if (mesh.faces(f, k) == vertices) mesh.faces(f, k) = 0;
    }
  }
  EXPECT_EQ(inspectMesh(mesh).components, 1);
  EXPECT_EQ(inspectMesh(mesh).nonManifoldVertices, 1);
  EXPECT_EQ(inspectMesh(mesh).unusedVertices, 1);
}

TEST(RequireClosedManifold, NamesTheFileAndTheCount) {
  EXPECT_NO_THROW(requireClosedManifold(makeIcosphere(1), "a.gii"));
  EXPECT_NO_THROW(requireManifold(makeRectangle(2, 2, 1, 1), "a.gii"));
  try {
    requireClosedManifold(makeRectangle(2, 2, 1, 1), "a.gii");
    FAIL() << "no exception";
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("a.gii"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("8 boundary edges"), std::string::npos);
  }
}

TEST(BuildTopology, RefusesBadIndicesAndThreeFacesAtAnEdge) {
  Faces faces(3, 3);
  faces << 0, 1, 2, 1, 0, 3, 0, 1, 4;
  EXPECT_THROW((void)buildTopology(faces, 5), InvalidInput);
  EXPECT_THROW((void)buildTopology(faces.topRows(2), 3), InvalidInput);
  EXPECT_NO_THROW((void)buildTopology(faces.topRows(2), 4));
}

TEST(ExtractFaces, KeepsPositionsAndOrigins) {
  const TriangleMesh mesh = makeIcosphere(2);
  const std::vector<std::int32_t> chosen = {7, 40, 3};
  const SubMesh part = extractFaces(mesh, chosen);
  ASSERT_EQ(part.mesh.faceCount(), 3);
  for (Eigen::Index f = 0; f < 3; ++f) {
    for (int k = 0; k < 3; ++k) EXPECT_EQ(part.mesh.corner(f, k), mesh.corner(chosen[f], k));
  }
  for (std::size_t v = 0; v < part.vertexOrigin.size(); ++v) {
    EXPECT_EQ(part.mesh.positions.row(v), mesh.positions.row(part.vertexOrigin[v]));
  }
}

TEST(Subdivide, KeepsTopologyAndQuadruplesFaces) {
  const TriangleMesh coarse = makeTorus(9, 7, 2, 0.6);
  const MeshCondition fine = inspectMesh(subdivide(coarse));
  EXPECT_EQ(fine.faces, 4 * coarse.faceCount());
  EXPECT_EQ(fine.eulerCharacteristic, 0);
  EXPECT_TRUE(fine.closedManifold());
}

}  // namespace
}  // namespace explica::geometry
