// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/VoxelSets.h"

#include <gtest/gtest.h>

#include <deque>
#include <random>

namespace explica {
namespace {

/// Each voxel of the set in a share of cases.
VoxelSet randomSet(const std::array<int, 3>& size, double share, unsigned seed) {
  Grid grid;
  grid.size = size;
  VoxelSet set(grid, 0);
  std::mt19937 random(seed);
  for (auto& voxel : set.data) voxel = random() < share * 4294967296.0 ? 1 + random() % 3 : 0;
  return set;
}

/// By flooding from each voxel that has no number yet.
Components flooded(const VoxelSet& set) {
  Components components;
  components.number = Volume<std::int32_t>(set.grid, -1);
  for (std::size_t seed = 0; seed < set.size(); ++seed) {
    if (set[seed] == 0 || components.number[seed] >= 0) continue;
    const auto number = static_cast<std::int32_t>(components.size.size());
    components.size.push_back(0);
    std::deque<std::size_t> front = {seed};
    components.number[seed] = number;
    while (!front.empty()) {
      ++components.size.back();
      for (const std::int64_t w : set.grid.neighbours(front.front())) {
        if (w < 0 || set[w] == 0 || components.number[w] >= 0) continue;
        components.number[w] = number;
        front.push_back(static_cast<std::size_t>(w));
      }
      front.pop_front();
    }
  }
  return components;
}

TEST(VoxelSets, ComponentsAreThoseOfAFloodInTheOrderOfTheirFirstVoxels) {
  const std::array<std::array<int, 3>, 6> sizes = {
      {{31, 17, 13}, {1, 40, 9}, {60, 1, 5}, {50, 40, 1}, {1, 1, 70}, {90, 1, 1}}};
  unsigned seed = 1;
  for (const auto& size : sizes) {
    for (const double share : {0.0, 0.2, 0.31, 0.5, 0.8, 1.0}) {  // about and off percolation
      const VoxelSet set = randomSet(size, share, ++seed);
      const Components found = componentsOf(set);
      const Components expected = flooded(set);
      EXPECT_EQ(found.size, expected.size) << seed;
      EXPECT_EQ(found.number.data, expected.number.data) << seed;
    }
  }
}

TEST(VoxelSets, SquaredDistancesAreThoseToTheNearestVoxel) {
  VoxelSet set = randomSet({14, 11, 9}, 0.004, 5);
  set.grid.spacing = Vector(1, 2, 0.5);
  std::vector<Point> places;
  for (std::size_t v = 0; v < set.size(); ++v) {
    const auto [i, j, k] = set.grid.subscripts(v);
    if (set[v] != 0) places.emplace_back(set.grid.toWorld(Vector(i, j, k)));
  }
  ASSERT_GT(places.size(), 2U);
  const Volume<float> squared = squaredDistanceTo(set);
  for (std::size_t v = 0; v < set.size(); ++v) {
    const auto [i, j, k] = set.grid.subscripts(v);
    double least = kInfinity;
    for (const Point& place : places) {
      least = std::min(least, (set.grid.toWorld(Vector(i, j, k)) - place).squaredNorm());
    }
    EXPECT_NEAR(squared[v], least, 1e-5) << v;
  }
}

}  // namespace
}  // namespace explica
