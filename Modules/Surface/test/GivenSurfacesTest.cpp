// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/GivenSurfaces.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Surface/Regions.h"

#include <gtest/gtest.h>

namespace explica::surface {
namespace {

TriangleMesh sphere(double radius, const Point& centre = Point::Zero()) {
  TriangleMesh mesh = geometry::makeIcosphere(4, radius);
  mesh.positions.rowwise() += centre.transpose();
  return mesh;
}

TEST(GivenSurfaces, ThicknessOfAShellIsItsWidth) {
  const TriangleMesh white = sphere(10), pial = sphere(13);
  const Eigen::VectorXd thickness = distanceThickness(white, pial);
  // A chord of the mesh lies within edge^2 / (8 R) of the sphere.
  const double edge = 13 * 1.2 / 16;
  EXPECT_GT(thickness.minCoeff(), 3 - edge * edge / 80);
  EXPECT_LT(thickness.maxCoeff(), 3 + 1e-9);
}

TEST(GivenSurfaces, ThicknessIsTheMeanOfBothWays) {
  // Eccentric spheres: the nearest way from either side, known in closed form.
  const Point shift(1, 0, 0);
  const TriangleMesh white = sphere(10), pial = sphere(14, shift);
  const Eigen::VectorXd thickness = distanceThickness(white, pial);
  for (Eigen::Index v = 0; v < white.vertexCount(); ++v) {
    const Point inner = white.positions.row(v).transpose();
    const Point outer = pial.positions.row(v).transpose();
    const double exact = 0.5 * ((14 - (inner - shift).norm()) + (outer.norm() - 10));
    ASSERT_NEAR(thickness[v], exact, 0.02) << v;
  }
}

TEST(GivenSurfaces, TakesOverAndAddsWhatIsMissing) {
  TriangleMesh white = sphere(10), pial = sphere(13);
  pial.positions.row(5) = white.positions.row(5);  // medial wall
  const CorticalSurfaces made = adoptSurfaces(white, pial);
  EXPECT_EQ(made.white.mesh.positions, white.positions);
  EXPECT_EQ(made.pial.faces, white.faces);
  EXPECT_EQ(made.mid.positions.row(7),
            (0.5 * (white.positions.row(7) + pial.positions.row(7))).eval());
  EXPECT_EQ(made.noRibbon, 1);
  EXPECT_EQ(made.thickness[5], 0);
  EXPECT_NEAR(made.curvature.mean(), -0.1, 0.005);
  EXPECT_THROW((void)adoptSurfaces(white, geometry::makeIcosphere(3, 13.0)), InvalidInput);
}

TEST(GivenSurfaces, FoldsAreTheSameWhicheverWayFacesRun) {
  TriangleMesh white = geometry::makeIcosphere(3, 20);
  TriangleMesh pial = geometry::makeIcosphere(3, 23);
  const CorticalSurfaces asked = adoptSurfaces(white, pial);
  for (TriangleMesh* mesh : {&white, &pial}) mesh->faces.col(1).swap(mesh->faces.col(2));
  const CorticalSurfaces found = adoptSurfaces(white, pial);
  EXPECT_LT((found.curvature - asked.curvature).norm(), 1e-9);
  EXPECT_LT((found.sulcalDepth - asked.sulcalDepth).norm(), 1e-9);
  EXPECT_LT(found.curvature.mean(), 0);  // of what bulges outwards
  EXPECT_EQ(found.white.mesh.faces, asked.white.mesh.faces);
}

TEST(Regions, AreThoseOfTheVoxelsWithinTheRibbon) {
  const TriangleMesh white = sphere(10), pial = sphere(13);
  Grid grid;
  grid.size = {40, 40, 40};
  grid.origin = {-19.5, -19.5, -19.5};
  Volume<Label> atlas(grid, 1);
  for (int k = 0; k < 40; ++k) {
    for (int j = 0; j < 40; ++j) {
      for (int i = 0; i < 40; ++i) atlas(i, j, k) = i < 20 ? 7 : (k < 20 ? 9 : 500);
    }
  }
  const auto counts = [](Label label) { return label != 500; };
  const VertexKeys keys = labelsWithin(atlas, white.positions, pial.positions, counts);
  for (Eigen::Index v = 0; v < keys.size(); ++v) {
    const double x = white.positions(v, 0);
    ASSERT_EQ(keys[v], x < 0 ? 7 : (white.positions(v, 2) < 0 ? 9 : keys[v])) << v;
  }
}

}  // namespace
}  // namespace explica::surface
