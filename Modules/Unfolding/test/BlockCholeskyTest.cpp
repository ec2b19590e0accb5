// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/BlockSystem.h"

#include "Explica/Core/Parallel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace explica::unfolding {
namespace {

/// A grid of springs, some of its points tied to far ones as contacts tie folds together.
struct Net {
  std::int32_t count = 0;
  Couplings couplings;
  std::vector<Eigen::Matrix3d> blocks;

  Net(std::int32_t side, int contacts, unsigned seed) : count(side * side) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::uniform_int_distribution<std::int32_t> any(0, count - 1);
    for (std::int32_t i = 0; i < count; ++i) {
      if (i % side > 0) couplings.emplace_back(i, i - 1);
      if (i >= side) couplings.emplace_back(i, i - side);
      if (i % side > 0 && i >= side) couplings.emplace_back(i, i - side - 1);
    }
    for (int n = 0; n < contacts; ++n) {
      const std::int32_t a = any(random), b = any(random);
      if (a != b) couplings.emplace_back(std::max(a, b), std::min(a, b));
    }
    for (std::size_t n = 0; n < couplings.size(); ++n) {
      const Eigen::Vector3d along(uniform(random), uniform(random), uniform(random));
      blocks.push_back(along * along.transpose() + 0.1 * Eigen::Matrix3d::Identity());
    }
  }
  void fill(BlockSystem& system, double diagonal) const {
    system.reset(count, couplings);
    for (std::size_t n = 0; n < couplings.size(); ++n) {
      const auto [i, j] = couplings[n];
      system.add(i, i, blocks[n]);
      system.add(j, j, blocks[n]);
      system.add(i, j, -blocks[n]);
    }
    system.addDiagonal(diagonal);
  }
  [[nodiscard]] Positions times(const Positions& x, double diagonal) const {
    Positions y = diagonal * x;
    for (std::size_t n = 0; n < couplings.size(); ++n) {
      const auto [i, j] = couplings[n];
      const Eigen::RowVector3d force = (x.row(i) - x.row(j)) * blocks[n];
      y.row(i) += force;
      y.row(j) -= force;
    }
    return y;
  }
};

Positions anyPoints(std::int32_t count) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Positions x(count, 3);
  for (Eigen::Index n = 0; n < x.size(); ++n) x.data()[n] = uniform(random);
  return x;
}

TEST(BlockCholesky, SolvesNetsOfEverySizeWithAndWithoutContacts) {
  for (const auto& [side, contacts] :
       {std::pair{1, 0}, {2, 0}, {3, 2}, {9, 30}, {40, 0}, {100, 300}}) {
    const Net net(side, contacts, 7);
    BlockSystem system;
    net.fill(system, 0.5);
    const Positions expected = anyPoints(net.count);
    Positions found;
    ASSERT_TRUE(system.solve(net.times(expected, 0.5), found));
    EXPECT_LT((found - expected).norm(), 1e-11 * expected.norm()) << side;
  }
}

TEST(BlockCholesky, PiecesWithoutConnectionAreSolvedEachOnItsOwn) {
  Net net(20, 0, 3);
  const auto apart = [](const auto& c) { return c.first / 200 != c.second / 200 || c.first > 390; };
  for (std::size_t n = net.couplings.size(); n-- > 0;) {
    if (!apart(net.couplings[n])) continue;
    net.couplings.erase(net.couplings.begin() + static_cast<std::ptrdiff_t>(n));
    net.blocks.erase(net.blocks.begin() + static_cast<std::ptrdiff_t>(n));
  }
  BlockSystem system;
  net.fill(system, 1);
  const Positions expected = anyPoints(net.count);
  Positions found;
  ASSERT_TRUE(system.solve(net.times(expected, 1), found));
  EXPECT_LT((found - expected).norm(), 1e-12 * expected.norm());
}

TEST(BlockCholesky, TheThreadsDoNotChangeAnyBit) {
  const Net net(90, 500, 11);
  const Positions right = anyPoints(net.count);
  Positions first;
  for (const int threads : {1, 2, 4}) {
    setThreadCount(threads);
    BlockSystem system;
    net.fill(system, 0.1);
    Positions found;
    ASSERT_TRUE(system.solve(right, found));
    if (threads == 1) first = found;
    EXPECT_EQ(found, first);
  }
  setThreadCount(0);
}

TEST(BlockCholesky, SaysThatAMatrixIsNotPositiveDefinite) {
  const Net net(30, 20, 5);
  BlockSystem system;
  net.fill(system, -0.4);
  Positions found;
  EXPECT_FALSE(system.solve(anyPoints(net.count), found));
}

TEST(BlockCholesky, AnOrderEliminatesTheGridWithFewFillIns) {
  // Nested dissection fills in 31/4 n log2 n blocks of an n-point grid at best [George1973]; a
  // natural order n^1.5.
  const Net net(100, 0, 5);
  BlockSystem system;
  net.fill(system, 1);
  const double points = net.count;
  EXPECT_LT(static_cast<double>(system.factor().factorSize()),
            9 * 7.75 * points * std::log2(points));
}

}  // namespace
}  // namespace explica::unfolding
