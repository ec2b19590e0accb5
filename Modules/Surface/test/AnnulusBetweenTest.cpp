// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/AnnulusBetween.h"
#include "../src/ColumnMeasures.h"
#include "Explica/Geometry/Fixtures.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::surface {
namespace {

constexpr double kBallRadius = 15;

Grid cubeOf40() {
  Grid grid;
  grid.size = {41, 41, 41};
  grid.origin = Point::Constant(-20);
  return grid;
}

/// A ball of tissue, its outer border known as a distance.
CorticalTissue ball(const Grid& grid = cubeOf40()) {
  CorticalTissue tissue;
  tissue.tissue = LevelSet(grid);
  tissue.insulated = Volume<std::uint8_t>(grid, 0);
  for (std::size_t v = 0; v < tissue.tissue.size(); ++v) {
    const auto s = tissue.tissue.grid.subscripts(v);
    const double inside = kBallRadius - grid.toWorld(Vector(s[0], s[1], s[2])).norm();
    tissue.tissue[v] = offZero(static_cast<float>(std::clamp(inside / 2, -1.0, 1.0)));
  }
  return tissue;
}

double thicknessAt(const harmonic::Annulus& annulus, const Point& at) {
  const auto found =
      correspondence::findCorrespondences(annulus, harmonic::solveInterpolant(annulus));
  return correspondence::thicknessAt(annulus, found, at).value_or(kNaN);
}

TEST(GridCrossings, TellInsideFromOutsideOnAnyVertex) {
  // Vertices on voxel centres and edges along grid lines.
  const TriangleMesh mesh = geometry::makeIcosphere(2, 8);
  const GridCrossings crossings(mesh, cubeOf40());
  for (int i = 0; i < 41; ++i) {
    for (int j = 0; j < 41; ++j) {
      for (int k = 0; k < 41; k += 3) {
        const double r = Point(i - 20, j - 20, k - 20).norm();
        if (r < 7.7 || r > 8.01) {
          EXPECT_EQ(crossings.inside({i, j, k}), r < 8) << r;
        }
      }
    }
  }
  const GridCrossings smaller(geometry::makeIcosphere(5, 7.5), cubeOf40());
  const auto found = smaller.between({27, 20, 20}, 0);
  ASSERT_TRUE(found.has_value());
  EXPECT_NEAR(found->first, 0.5, 0.01);
  EXPECT_EQ(found->first, found->second);
  EXPECT_FALSE(smaller.between({24, 20, 20}, 0).has_value());
}

TEST(AnnulusBetween, HasTheThicknessOfAShell) {
  const auto annulus = annulusBetween(geometry::makeIcosphere(5, 12.3), ball(), {});
  EXPECT_NEAR(thicknessAt(annulus, Point(0, 8, 11)), kBallRadius - 12.3, 0.03);
}

TEST(AnnulusBetween, HasItOnAnObliqueMirroredGridOfOtherSpacing) {
  Grid grid;
  grid.size = {51, 41, 33};
  grid.spacing = {0.8, 1, 1.25};
  grid.direction << std::cos(0.3), std::sin(0.3), 0, std::sin(0.3), -std::cos(0.3), 0, 0, 0, 1;
  grid.origin = -grid.direction * Vector(20, 20, 20);
  const auto annulus = annulusBetween(geometry::makeIcosphere(5, 12.3), ball(grid), {});
  EXPECT_NEAR(thicknessAt(annulus, Point(0, 8, 11)), kBallRadius - 12.3, 0.05);
}

/// Two closed surfaces as one mesh.
TriangleMesh together(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both = a;
  both.positions.conservativeResize(a.vertexCount() + b.vertexCount(), 3);
  both.positions.bottomRows(b.vertexCount()) = b.positions;
  both.faces.conservativeResize(a.faceCount() + b.faceCount(), 3);
  both.faces.bottomRows(b.faceCount()) =
      b.faces.array() + static_cast<std::int32_t>(a.vertexCount());
  return both;
}

/// A disc of 11 mm and of 0.3 mm between the voxel centres of two planes.
TriangleMesh thinDisc() {
  TriangleMesh disc = geometry::makeIcosphere(5, 11);
  for (Eigen::Index v = 0; v < disc.vertexCount(); ++v) {
    disc.positions(v, 2) = 0.5 + 0.15 / 11 * disc.positions(v, 2);
  }
  return disc;
}

/// How many links across the disc end at a boundary, where the disc begins.
std::size_t partedBy(const harmonic::Annulus& annulus, std::int32_t boundary) {
  std::size_t parted = 0;
  for (std::size_t n = 0; n < annulus.count(); ++n) {
    const auto s = annulus.voxel(static_cast<std::int32_t>(n));
    const double r = std::hypot(s[0] - 20, s[1] - 20);
    if (s[2] != 20 || r < 6 || r > 10) continue;
    EXPECT_EQ(annulus.links[n][5], boundary) << r;
    EXPECT_NEAR(annulus.fractions[annulus.irregular(static_cast<std::int32_t>(n))][5], 0.4, 0.07);
    ++parted;
  }
  return parted;
}

TEST(AnnulusBetween, ABladeThinnerThanAVoxelParts) {
  // No voxel's centre lies in the blade; the core has voxels of white matter.
  const auto annulus =
      annulusBetween(together(geometry::makeIcosphere(4, 5), thinDisc()), ball(), {});
  EXPECT_GT(partedBy(annulus, harmonic::kInner), 100U);
}

TEST(AnnulusBetween, ASulcusThinnerThanAVoxelParts) {
  const auto annulus = annulusBetween(geometry::makeIcosphere(4, 5),
                                      together(geometry::makeIcosphere(5, kBallRadius), thinDisc()),
                                      ball().insulated, {});
  EXPECT_GT(partedBy(annulus, harmonic::kOuter), 100U);
}

TEST(AnnulusBetween, TwoSurfacesHaveTheThicknessOfAShellOnLongVoxels) {
  Grid grid;
  grid.size = {41, 41, 21};
  grid.spacing = {1, 1, 2};
  grid.direction << std::cos(0.3), std::sin(0.3), 0, std::sin(0.3), -std::cos(0.3), 0, 0, 0, 1;
  grid.origin = -grid.direction * Vector(20, 20, 20);
  const auto annulus =
      annulusBetween(geometry::makeIcosphere(5, 12.3), geometry::makeIcosphere(5, kBallRadius),
                     Volume<std::uint8_t>(grid, 0), {});
  EXPECT_EQ(annulus.grid.spacing, Vector::Ones());
  for (const Point& at : {Point(0, 8, 11), Point(0, 0, 13.6), Point(13.6, 0, 0)}) {
    EXPECT_NEAR(thicknessAt(annulus, at), kBallRadius - 12.3, 0.05) << at.transpose();
  }
}

}  // namespace
}  // namespace explica::surface
