// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/LabelVolume.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"

#include <gtest/gtest.h>

namespace explica::maps {
namespace {

TriangleMesh ball(int level, double radius) {
  TriangleMesh mesh = geometry::makeIcosphere(level);
  mesh.positions *= radius;
  return mesh;
}

TEST(LabelVolume, FillsAShellByTheLabelsOfItsVertices) {
  const TriangleMesh white = ball(4, 20), pial = ball(4, 23);
  VertexKeys keys(white.vertexCount());
  for (Eigen::Index v = 0; v < keys.size(); ++v) keys[v] = white.positions(v, 2) > 0 ? 7 : 3;
  const Volume<Label> labels = labelsBetween(gridAround(pial.positions, 1), white, pial, keys);
  double voxels = 0, wrong = 0;
  for (std::size_t v = 0; v < labels.size(); ++v) {
    if (labels[v] == 0) continue;
    ++voxels;
    const auto [i, j, k] = labels.grid.subscripts(v);
    const Point at = labels.grid.toWorld(Vector(i, j, k));
    EXPECT_GT(at.norm(), 20 - 0.9);
    EXPECT_LT(at.norm(), 23 + 0.9);
    // Neighbouring vertices are 1.5 mm apart.
    if (std::abs(at.z()) > 1.5) wrong += labels[v] != (at.z() > 0 ? 7 : 3);
  }
  const double shell = 4.0 / 3 * kPi * (23 * 23 * 23 - 20 * 20 * 20);
  EXPECT_NEAR(voxels, shell, 0.02 * shell);
  EXPECT_EQ(wrong, 0);
}

TEST(LabelVolume, LeavesOutVerticesWithoutALabel) {
  const TriangleMesh white = ball(3, 10), pial = ball(3, 13);
  const VertexKeys none = VertexKeys::Zero(white.vertexCount());
  const Volume<Label> labels = labelsBetween(gridAround(pial.positions, 1), white, pial, none);
  EXPECT_EQ(std::count(labels.data.begin(), labels.data.end(), 0),
            static_cast<std::ptrdiff_t>(labels.size()));
}

TEST(LabelVolume, RefusesSurfacesOfOtherFaces) {
  const TriangleMesh white = ball(3, 10), pial = ball(2, 13);
  EXPECT_THROW(static_cast<void>(labelsBetween(gridAround(pial.positions, 1), white, pial,
                                               VertexKeys::Ones(white.vertexCount()))),
               InvalidInput);
}

}  // namespace
}  // namespace explica::maps
