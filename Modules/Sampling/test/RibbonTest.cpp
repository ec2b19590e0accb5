// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/Ribbon.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Testing/Grids.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::sampling {
namespace {

Grid cube() {
  Grid grid;
  grid.size = {64, 64, 64};
  grid.spacing = Vector::Constant(0.5);
  grid.origin = Vector::Constant(-15.75);
  return grid;
}

template <class Function>
std::vector<float> imageOf(const Grid& grid, const Function& f) {
  std::vector<float> image(grid.voxelCount());
  for (std::size_t v = 0; v < image.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    image[v] = static_cast<float>(f(grid.toWorld(Vector(i, j, k))));
  }
  return image;
}

TEST(RibbonSampler, AveragesByVolumeBetweenSpheres) {
  const TriangleMesh white = geometry::makeIcosphere(4, 8), pial = geometry::makeIcosphere(4, 12);
  const Grid grid = cube();
  std::vector<float> frames = imageOf(grid, [](const Point& x) { return x.norm(); });
  const std::vector<float> second = imageOf(grid, [](const Point& x) { return x.z(); });
  frames.insert(frames.end(), second.begin(), second.end());
  const std::vector<float> got = RibbonSampler(grid, white, pial).sample(frames);
  const auto count = static_cast<std::size_t>(white.vertexCount());
  ASSERT_EQ(got.size(), 2 * count);
  // Mean radius of a shell: 3/4 (b^4 - a^4) / (b^3 - a^3), on facets a little less.
  const double mean =
      0.75 * (std::pow(12, 4) - std::pow(8, 4)) / (std::pow(12, 3) - std::pow(8, 3));
  for (std::size_t v = 0; v < count; ++v) {
    EXPECT_NEAR(got[v], mean, 0.006 * mean);
    const double z = white.positions(static_cast<Eigen::Index>(v), 2) / 8;
    EXPECT_NEAR(got[count + v], mean * z, 0.012 * mean);
  }
}

TEST(RibbonSampler, KnowsAVertexWhoseTissueIsKnownByHalf) {
  const TriangleMesh white = geometry::makeIcosphere(3, 8), pial = geometry::makeIcosphere(3, 12);
  const Grid grid = cube();
  const std::vector<float> image =
      imageOf(grid, [](const Point& x) { return x.z() < 0 ? kNaN : 5.0; });
  const std::vector<float> got = RibbonSampler(grid, white, pial).sample(image);
  for (Eigen::Index v = 0; v < white.vertexCount(); ++v) {
    const double z = white.positions(v, 2);
    if (z > 2) {
      EXPECT_NEAR(got[static_cast<std::size_t>(v)], 5, 1e-5);
    }
    if (z < -2) {
      EXPECT_TRUE(std::isnan(got[static_cast<std::size_t>(v)]));
    }
  }
}

TEST(RibbonSampler, FollowsATransformAndRefusesStrangers) {
  const TriangleMesh white = geometry::makeIcosphere(3, 8), pial = geometry::makeIcosphere(3, 12);
  const Grid grid = cube();
  const std::vector<float> image = imageOf(grid, [](const Point& x) { return x.x(); });
  const auto moved = [](const Positions& points) -> Positions {
    return points.rowwise() + Eigen::RowVector3d(2, 0, 0);
  };
  const auto here = RibbonSampler(grid, white, pial).sample(image);
  const auto there = RibbonSampler(grid, white, pial, Interpolation::Linear, moved).sample(image);
  for (std::size_t v = 0; v < here.size(); ++v) EXPECT_NEAR(there[v] - here[v], 2, 1e-4);
  EXPECT_THROW(RibbonSampler(grid, white, geometry::makeIcosphere(2, 9)), InvalidInput);
}

TEST(RibbonSampler, GivesAValueWhereTheSurfacesTouch) {
  const TriangleMesh white = geometry::makeIcosphere(3, 8);
  const Grid grid = cube();
  const auto got =
      RibbonSampler(grid, white, white).sample(imageOf(grid, [](const Point&) { return 3.0; }));
  for (const float value : got) EXPECT_NEAR(value, 3, 1e-5);
}

}  // namespace
}  // namespace explica::sampling
