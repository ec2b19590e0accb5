// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/Thinning.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/IsoSurface.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::surface {
namespace {

/// Two lobes beside each other, a slit of one voxel between them, joined at the bottom.
LevelSet slit() {
  Grid grid;
  grid.size = {40, 40, 40};
  Volume<std::uint8_t> mask(grid, 0);
  for (int k = 4; k < 36; ++k) {
    for (int j = 4; j < 36; ++j) {
      for (int i = 4; i < 36; ++i) mask(i, j, k) = !((i == 19 || j == 12 || j == 14) && k > 10);
    }
  }
  return levelSetOf(mask);
}

LevelSet torus() {
  Grid grid;
  grid.size = {48, 48, 20};
  Volume<std::uint8_t> mask(grid, 0);
  for (int k = 0; k < 20; ++k) {
    for (int j = 0; j < 48; ++j) {
      for (int i = 0; i < 48; ++i) {
        const double ring = std::hypot(i - 23.5, j - 23.5) - 15;
        mask(i, j, k) = std::hypot(ring, k - 9.5) < 5;
      }
    }
  }
  return levelSetOf(mask);
}

/// Chords cut a volume off that grows as the square of their length.
void expectThinned(const LevelSet& level, double edge, std::int64_t characteristic) {
  const TriangleMesh mesh = geometry::extractIsoSurface(level);
  const TriangleMesh thin = thinned(mesh, level, edge);
  const auto condition = geometry::requireClosedManifold(thin, "thinned");
  EXPECT_EQ(condition.eulerCharacteristic, characteristic);
  EXPECT_EQ(condition.unusedVertices, 0);
  EXPECT_TRUE(geometry::findSelfIntersections(thin).empty());
  EXPECT_LT(thin.faceCount(), mesh.faceCount() / 3);
  EXPECT_NEAR(geometry::enclosedVolume(thin), geometry::enclosedVolume(mesh),
              0.006 * edge * edge * geometry::enclosedVolume(mesh));
}

TEST(Thinning, LeavesTheTopologyAndNoFacesThatMeet) {
  for (const double edge : {1.5, 2.5, 4.0}) {
    SCOPED_TRACE(edge);
    expectThinned(slit(), edge, 2);
    expectThinned(torus(), edge, 0);
  }
}

TEST(Thinning, IsTheSameForAnyNumberOfThreads) {
  const LevelSet level = slit();
  const TriangleMesh mesh = geometry::extractIsoSurface(level);
  const TriangleMesh several = thinned(mesh, level, 2);
  setThreadCount(1);
  const TriangleMesh one = thinned(mesh, level, 2);
  setThreadCount(0);
  EXPECT_EQ(several.faces, one.faces);
  EXPECT_EQ(several.positions, one.positions);
}

TEST(Thinning, LeavesRimsAsTheyAre) {
  const LevelSet level = torus();
  Volume<std::uint8_t> known(level.grid, 1);
  for (int k = 0; k < 20; ++k) {
    for (int j = 0; j < 48; ++j) {
      for (int i = 0; i < 20; ++i) known(i, j, k) = 0;
    }
  }
  const TriangleMesh mesh = geometry::extractIsoSurface(level, known);
  const TriangleMesh thin = thinned(mesh, level, 2);
  const auto before = geometry::requireManifold(mesh, "mesh");
  const auto after = geometry::requireManifold(thin, "thinned");
  EXPECT_EQ(after.eulerCharacteristic, before.eulerCharacteristic);
  EXPECT_EQ(after.boundaryEdges, before.boundaryEdges);
  EXPECT_LT(thin.faceCount(), mesh.faceCount() / 2);
  EXPECT_TRUE(geometry::findSelfIntersections(thin).empty());
}

}  // namespace
}  // namespace explica::surface
