// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/IsoSurface.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/Surface/TopologyCorrection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace explica::surface {
namespace {

Grid cube(int n, double spacing) {
  Grid grid;
  grid.size = {n, n, n};
  grid.spacing = Vector::Constant(spacing);
  grid.origin = Vector::Constant(-0.5 * (n - 1) * spacing);
  return grid;
}

template <class Inside>
LevelSet levelFrom(const Grid& grid, const Inside& distance) {
  LevelSet level(grid);
  for (std::size_t v = 0; v < level.size(); ++v) {
    const auto s = grid.subscripts(v);
    const double d = std::clamp(distance(grid.toWorld(Vector(s[0], s[1], s[2]))), -1.0, 1.0);
    level[v] = static_cast<float>(std::abs(d) < 1e-4 ? 1e-4 : d);
  }
  return level;
}

double torus(const Point& p, double major, double minor) {
  return minor - std::hypot(std::hypot(p.x(), p.y()) - major, p.z());
}

std::int64_t eulerOfMesh(const LevelSet& level) {
  return geometry::inspectMesh(geometry::extractIsoSurface(level)).eulerCharacteristic;
}

TEST(TopologyCorrection, LeavesABallAlone) {
  const auto level = levelFrom(cube(24, 1), [](const Point& p) { return 8 - p.norm(); });
  const auto result = correctTopology(level);
  EXPECT_TRUE(result.defects.empty());
  EXPECT_EQ(result.level.data, level.data);
  EXPECT_EQ(boundaryEulerCharacteristic(level), 2);
}

TEST(TopologyCorrection, CutsAThinRing) {
  const auto level = levelFrom(cube(40, 1), [](const Point& p) { return torus(p, 14, 2.2); });
  EXPECT_EQ(boundaryEulerCharacteristic(level), 0);
  const auto result = correctTopology(level);
  ASSERT_EQ(result.defects.size(), 1u);
  EXPECT_EQ(result.defects[0].kind, DefectKind::Handle);
  EXPECT_NEAR(std::hypot(result.defects[0].place.x(), result.defects[0].place.y()), 14, 1.5);
  EXPECT_EQ(boundaryEulerCharacteristic(result.level), 2);
}

TEST(TopologyCorrection, FillsASmallHoleThroughAThickRing) {
  const auto level = levelFrom(cube(40, 1), [](const Point& p) { return torus(p, 9, 7.5); });
  EXPECT_EQ(boundaryEulerCharacteristic(level), 0);
  const auto result = correctTopology(level);
  ASSERT_EQ(result.defects.size(), 1u);
  EXPECT_EQ(result.defects[0].kind, DefectKind::Tunnel);
  EXPECT_LT(result.defects[0].place.norm(), 2.0);
  EXPECT_LT(result.defects[0].cost, result.defects[0].alternativeCost);
  EXPECT_EQ(boundaryEulerCharacteristic(result.level), 2);
}

TEST(TopologyCorrection, KeepsHandlesIfAsked) {
  auto level = levelFrom(cube(40, 1), [](const Point& p) { return torus(p, 12, 4); });
  level(20, 20, 20) = 1;   // an island in the hole
  level(32, 20, 20) = -1;  // a cavity in the tube
  const auto result = correctTopology(level, GenusRule::Keep);
  EXPECT_EQ(result.handlesLeft, 1);
  ASSERT_EQ(result.defects.size(), 2u);
  EXPECT_EQ(result.voxelsChanged, 2);
}

TEST(TopologyCorrection, MakesASphereOfNoise) {
  const auto grid = cube(26, 1);
  for (unsigned seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    LevelSet level(grid, -1.0F);
    for (int k = 1; k < 25; ++k) {
      for (int j = 1; j < 25; ++j) {
        for (int i = 1; i < 25; ++i) {
          const double r = grid.toWorld(Vector(i, j, k)).norm();
          const bool inside = (r < 9) != (random() % 100 < 8 * seed);
          level(i, j, k) = inside ? 0.5F : -0.5F;
        }
      }
    }
    const auto result = correctTopology(level);
    EXPECT_EQ(boundaryEulerCharacteristic(result.level), 2);
    const auto mesh = geometry::extractIsoSurface(result.level);
    const auto condition = geometry::inspectMesh(mesh);
    EXPECT_TRUE(condition.closedManifold());
    EXPECT_EQ(condition.eulerCharacteristic, 2);
    EXPECT_EQ(condition.components, 1);
    EXPECT_TRUE(geometry::findSelfIntersections(mesh).empty());
    std::int64_t listed = 0;
    for (const auto& defect : result.defects) {
      listed += defect.voxels;
      EXPECT_FALSE(defect.cost > defect.alternativeCost) << defect.cost << " at " << defect.place;
    }
    EXPECT_GE(listed, result.voxelsChanged);
  }
}

TEST(TopologyCorrection, RefusesAnEmptyLevel) {
  EXPECT_THROW((void)correctTopology(LevelSet(cube(8, 1), -1.0F)), InvalidInput);
  EXPECT_THROW((void)correctTopology(LevelSet(cube(8, 1), 1.0F)), InvalidInput);
}

TEST(IsoSurface, HasTheTopologyOfItsLattice) {
  std::mt19937 random(7);
  LevelSet level(cube(16, 1), -1.0F);
  for (int k = 1; k < 15; ++k) {
    for (int j = 1; j < 15; ++j) {
      for (int i = 1; i < 15; ++i) level(i, j, k) = static_cast<float>(random() % 200) - 99.5F;
    }
  }
  EXPECT_EQ(eulerOfMesh(level), boundaryEulerCharacteristic(level));
  EXPECT_TRUE(geometry::inspectMesh(geometry::extractIsoSurface(level)).closedManifold());
}

TEST(IsoSurface, PointsOutwardOnMirroredAndObliqueGrids) {
  for (const double sign : {1.0, -1.0}) {
    Grid grid = cube(20, 1);
    grid.spacing = Vector(1, 1.5, 0.8);
    const double a = 0.4;
    grid.direction << sign * std::cos(a), -std::sin(a), 0, sign * std::sin(a), std::cos(a), 0, 0, 0,
        1;
    grid.origin = -(grid.toWorld(Vector::Constant(9.5)) - grid.origin);
    const auto level = levelFrom(grid, [](const Point& p) { return (6 - p.norm()) / 2; });
    const double volume = geometry::enclosedVolume(geometry::extractIsoSurface(level));
    EXPECT_NEAR(volume, 4.0 / 3 * kPi * 216, 20);
  }
}

TEST(IsoSurface, ConvergesAtSecondOrder) {
  // Errors of one radius cancel by chance at some spacing: the mean square over several does not.
  double volumeError[3] = {}, areaError[3] = {};
  for (int s = 0; s < 3; ++s) {
    const double h = 1.0 / (1 << s);
    for (const double radius : {8.1, 8.43, 8.77, 9.2, 9.61}) {
      const auto level = levelFrom(cube(24 << s, h),
                                   [&](const Point& p) { return (radius - p.norm()) / (4 * h); });
      const auto mesh = geometry::extractIsoSurface(level);
      const double volume = 4.0 / 3 * kPi * std::pow(radius, 3), area = 4 * kPi * radius * radius;
      volumeError[s] += std::pow(geometry::enclosedVolume(mesh) / volume - 1, 2);
      areaError[s] += std::pow(geometry::totalArea(mesh) / area - 1, 2);
    }
  }
  for (int s = 0; s < 2; ++s) {
    EXPECT_NEAR(0.5 * std::log2(volumeError[s] / volumeError[s + 1]), 2, 0.25);
  }
  // Bumps of slivers add area where chords lose it, so that single steps of the rate scatter.
  EXPECT_NEAR(0.25 * std::log2(areaError[0] / areaError[2]), 2.2, 0.4);
}

}  // namespace
}  // namespace explica::surface
