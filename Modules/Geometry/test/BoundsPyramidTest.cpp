// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/BoundsSearch.h"
#include "Explica/Testing/InstructionSets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <utility>

namespace explica::geometry {
namespace {

/// Boxes of a few units in a cube, each with motions of its own about a common one.
std::vector<MotionBounds> randomBounds(std::size_t count, double speed, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto any = [&] { return Vector(uniform(random), uniform(random), uniform(random)); };
  std::vector<MotionBounds> bounds;
  for (std::size_t n = 0; n < count; ++n) {
    const Point centre = 4 * any();
    bounds.push_back(MotionBounds::ofPoint(centre, Vector(9, 0, 0) + speed * any()));
    bounds.back().extend(MotionBounds::ofPoint(centre + any(), Vector(9, 0, 0) + speed * any()));
  }
  return bounds;
}

std::set<std::pair<std::int32_t, std::int32_t>> searched(const BoundsPyramid& first,
                                                         const BoundsPyramid& second,
                                                         double reach) {
  const BoundsSearch search{&first, &second, static_cast<float>(reach * reach)};
  std::set<std::pair<std::int32_t, std::int32_t>> found;
  std::size_t visits = 0;
  for (const BlockPair& pair : blocksToShareOut(search)) {
    visitItems(search, pair, [&](std::int32_t i, std::int32_t j) {
      ++visits;
      found.emplace(&first == &second ? std::min(i, j) : i, &first == &second ? std::max(i, j) : j);
    });
  }
  EXPECT_EQ(visits, found.size());  // none twice
  return found;
}

/// Least distance of the boxes over the motion, each axis for itself at its most favourable speed.
double leastDistance(const MotionBounds& a, const MotionBounds& b) {
  double squared = 0;
  for (int k = 0; k < 3; ++k) {
    const double above = double{a.lower[k]} - b.upper[k] - std::max(0.0F, b.most[k] - a.least[k]);
    const double below = double{b.lower[k]} - a.upper[k] - std::max(0.0F, a.most[k] - b.least[k]);
    const double gap = std::max({0.0, above, below});
    squared += gap * gap;
  }
  return std::sqrt(squared);
}

/// True if what is near was found and what is far was not, but for rounding.
bool agrees(bool found, double distance, double reach) {
  constexpr double kSingle = 1e-4;
  return found ? distance < reach + kSingle : distance > reach - kSingle;
}

TEST(BoundsPyramid, FindsAllPairsOfBruteForceAtEverySize) {
  for (const std::size_t count : {1, 2, 7, 8, 9, 64, 65, 700}) {
    const auto items = randomBounds(count, 1, 1);
    const auto others = randomBounds(count / 2 + 1, 1, 2);
    const BoundsPyramid own(items), second(others);
    const double reach = 0.5;
    const auto pairs = searched(own, own, reach), across = searched(own, second, reach);
    std::size_t near = 0;
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(count); ++i) {
      for (std::int32_t j = i + 1; j < static_cast<std::int32_t>(count); ++j) {
        const double distance = leastDistance(items[i], items[j]);
        ASSERT_TRUE(agrees(pairs.count({i, j}) > 0, distance, reach)) << i << " " << j;
        near += pairs.count({i, j});
      }
      for (std::int32_t j = 0; j < static_cast<std::int32_t>(others.size()); ++j) {
        const double distance = leastDistance(items[i], others[j]);
        ASSERT_TRUE(agrees(across.count({i, j}) > 0, distance, reach)) << i << " " << j;
      }
    }
    EXPECT_EQ(near, pairs.size());
    EXPECT_GE(pairs.size(), count < 100 ? 0 : count / 8);
  }
}

TEST(BoundsPyramid, ACommonMotionBringsNothingTogether) {
  const auto moving = randomBounds(300, 0, 3);
  std::vector<MotionBounds> still = moving;
  for (MotionBounds& m : still) {
    for (int k = 0; k < 3; ++k) m.least[k] = m.most[k] = 0;
  }
  const BoundsPyramid a(moving), b(still);
  EXPECT_EQ(searched(a, a, 0.1).size(), searched(b, b, 0.1).size());
}

TEST(BoundsPyramid, WhatIsBeyondSinglePrecisionIsNearToAll) {
  auto items = randomBounds(20, 1, 4);
  items.push_back(MotionBounds::ofPoint(Vector(1e200, 0, 0), Vector::Zero()));
  items.push_back(MotionBounds::ofPoint(Vector(kNaN, 0, 0), Vector::Zero()));
  items.push_back(MotionBounds::ofPoint(Vector::Zero(), Vector(kInfinity, 0, 0)));
  const BoundsPyramid pyramid(items);
  const auto pairs = searched(pyramid, pyramid, 1e-3);
  EXPECT_TRUE(pairs.count({20, 21}));
}

TEST(BoundsPyramid, EveryInstructionSetAndThreadCountFindsTheSame) {
  const auto items = randomBounds(5000, 1, 5);
  const auto search = [&] {
    const BoundsPyramid pyramid(items);
    return searched(pyramid, pyramid, 0.1);
  };
  const auto widest = search();
  setThreadCount(1);
  EXPECT_EQ(search(), widest);
  setThreadCount(0);
  testing::forEachNarrowerInstructionSet(
      [&](std::int64_t target) { EXPECT_EQ(search(), widest) << target; });
}

}  // namespace
}  // namespace explica::geometry
