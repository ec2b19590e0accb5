// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Permutation.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Core/Types.h"
#include "Explica/Geometry/Fixtures.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Statistics/PlaceModel.h"
#include "Explica/Testing/InstructionSets.h"
#include "RandomNumbers.h"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <algorithm>
#include <numeric>
#include <set>

namespace explica::statistics {
namespace {

using testing::normalMatrix;

/// An intercept, a covariate and two groups.
Design designOf(Eigen::Index n) {
  Design d;
  d.matrix = Eigen::MatrixXd::Ones(n, 3);
  d.matrix.col(1) = normalMatrix(n, 1, 100);
  for (Eigen::Index i = 0; i < n; ++i) d.matrix(i, 2) = i % 2 == 0 ? 0 : 1;
  return d;
}

Contrast column(Eigen::Index p, Eigen::Index c) {
  return {"c", "c", Eigen::VectorXd::Unit(p, c)};
}

Eigen::VectorXd statisticOf(const Design& d, const Contrast& c, const Eigen::MatrixXd& y) {
  ModelMaps maps(d.matrix.cols(), y.cols(), 1);
  fitPlaces(d, {c}, y, 0, maps);
  return maps.contrasts[0].statistic;
}

/// Residuals of the model without some columns.
Eigen::MatrixXd without(const Design& d, Eigen::Index kept, const Eigen::MatrixXd& y) {
  const Eigen::MatrixXd z = d.matrix.leftCols(kept);
  return y - z * (z.transpose() * z).inverse() * z.transpose() * y;
}

void expectSameMaxima(std::vector<float> ours, std::vector<double> brute) {
  std::sort(ours.begin(), ours.end());
  std::sort(brute.begin(), brute.end());
  ASSERT_EQ(ours.size(), brute.size());
  for (std::size_t i = 0; i < brute.size(); ++i) EXPECT_NEAR(ours[i], brute[i], 2e-4 * brute[i]);
}

TEST(Permutation, OfFivePeopleIsEveryShuffleOfTheResiduals) {
  const Design d = designOf(5);
  const Eigen::MatrixXd y = normalMatrix(5, 7, 31);
  PermutationOptions options;
  options.count = 1000;
  const PermutationResult found = permute(d, column(3, 2), y, nullptr, options);
  EXPECT_TRUE(found.exhaustive);
  EXPECT_EQ(found.exchange, Exchange::Within);
  const Eigen::MatrixXd rest = without(d, 2, y);
  std::vector<int> order(5);
  std::iota(order.begin(), order.end(), 0);
  std::vector<double> brute;
  do {
    brute.push_back(statisticOf(d, column(3, 2), rest(order, Eigen::all)).cwiseAbs().maxCoeff());
  } while (std::next_permutation(order.begin(), order.end()));
  expectSameMaxima(found.statistic, brute);
  const Eigen::VectorXd t = statisticOf(d, column(3, 2), y);
  for (Eigen::Index v = 0; v < 7; ++v) EXPECT_NEAR(found.observed[v], t[v], 1e-4 * std::abs(t[v]));
}

TEST(Permutation, OfAnFTestLikewise) {
  const Design d = designOf(6);
  const Contrast f{"f", "f", Eigen::MatrixXd::Identity(3, 3).rightCols(2)};
  const Eigen::MatrixXd y = normalMatrix(6, 3, 32);
  PermutationOptions options;
  options.count = 1000;
  const PermutationResult found = permute(d, f, y, nullptr, options);
  const Eigen::MatrixXd rest = without(d, 1, y);
  std::vector<int> order(6);
  std::iota(order.begin(), order.end(), 0);
  std::vector<double> brute;
  do {
    brute.push_back(statisticOf(d, f, rest(order, Eigen::all)).maxCoeff());
  } while (std::next_permutation(order.begin(), order.end()));
  expectSameMaxima(found.statistic, brute);
}

TEST(Permutation, OfAMeanFlipsSigns) {
  Design d;
  d.matrix = Eigen::MatrixXd::Ones(6, 1);
  const Eigen::MatrixXd y = normalMatrix(6, 4, 33);
  PermutationOptions options;
  options.count = 1000;
  const PermutationResult found = permute(d, column(1, 0), y, nullptr, options);
  EXPECT_EQ(found.exchange, Exchange::Signs);
  std::vector<double> brute;
  for (int code = 0; code < 64; ++code) {
    Eigen::MatrixXd flipped = y;
    for (int i = 0; i < 6; ++i) {
      if ((code >> i & 1) != 0) flipped.row(i) *= -1;
    }
    brute.push_back(statisticOf(d, column(1, 0), flipped).cwiseAbs().maxCoeff());
  }
  expectSameMaxima(found.statistic, brute);
}

TEST(Permutation, ShufflesStayInTheirBlocks) {
  const std::vector<int> blocks = {0, 0, 0, 1, 1, 1, 1, 2, 2};
  const Shuffler within(9, blocks, Exchange::Within, 50, 7);
  const Shuffler whole(9, {0, 0, 1, 1, 2, 2, 3, 3, 3}, Exchange::Whole, 5, 7);
  std::vector<std::int32_t> order(9);
  std::vector<float> signs(9);
  for (int k = 1; k < 50; ++k) {
    within.draw(k, order, signs);
    for (std::size_t i = 0; i < 9; ++i)
      EXPECT_EQ(blocks[static_cast<std::size_t>(order[i])], blocks[i]);
  }
  EXPECT_EQ(whole.count(), 6);  // 3! of the blocks of two; the block of three has no partner
  EXPECT_TRUE(whole.exhaustive());
  for (int k = 0; k < 6; ++k) {
    whole.draw(k, order, signs);
    EXPECT_EQ(order[1], order[0] + 1);
    EXPECT_EQ(order[7], 7);
  }
}

TEST(Permutation, ShufflesAreEquallyLikely) {
  const Shuffler shuffler(4, {}, Exchange::Within, 10, 3);  // 24 are possible
  ASSERT_FALSE(shuffler.exhaustive());
  std::map<std::vector<std::int32_t>, int> counts;
  std::vector<std::int32_t> order(4);
  std::vector<float> signs(4);
  for (int k = 1; k <= 24000; ++k) {
    shuffler.draw(k, order, signs);
    ++counts[order];
  }
  double chiSquared = 0;
  for (const auto& [o, n] : counts) chiSquared += std::pow(n - 1000.0, 2) / 1000;
  EXPECT_EQ(counts.size(), 24U);
  EXPECT_LT(chiSquared, 49.7);  // P 0.001 at 23 degrees of freedom
}

TEST(Permutation, BlocksOfARepeatedMeasureAreExchangedAsTheEffectVaries) {
  Design d = designOf(12);
  PermutationOptions options;
  options.count = 20;
  for (int i = 0; i < 12; ++i) options.blocks.push_back(i / 2);
  const Eigen::MatrixXd y = normalMatrix(12, 2, 34);
  EXPECT_EQ(permute(d, column(3, 2), y, nullptr, options).exchange, Exchange::Within);
  for (Eigen::Index i = 0; i < 12; ++i) d.matrix(i, 2) = i < 6 ? 0 : 1;
  EXPECT_EQ(permute(d, column(3, 2), y, nullptr, options).exchange, Exchange::Whole);
  options.exchange = Exchange::Within;
  EXPECT_THROW((void)permute(d, column(3, 2), y, nullptr, options), InvalidInput);
}

struct Field {
  PlaceGraph graph;
  Eigen::Index places;
};
Field sphere() {
  const TriangleMesh mesh = geometry::makeIcosphere(2, 10);
  const Eigen::VectorXf areas = geometry::vertexAreas(mesh).cast<float>();
  return {{geometry::buildTopology(mesh.faces, mesh.vertexCount()).vertexVertices,
           {areas.data(), areas.data() + areas.size()}},
          mesh.vertexCount()};
}

TEST(Permutation, IsTheSameWithAnyNumberOfThreads) {
  const Field field = sphere();
  PermutationOptions options;
  options.count = 300;
  options.clusterThreshold = 1.5;
  options.tfce = true;
  const Eigen::MatrixXd y = normalMatrix(20, field.places, 35);
  std::vector<PermutationResult> results;
  for (const int threads : {1, 3}) {
    setThreadCount(threads);
    results.push_back(permute(designOf(20), column(3, 2), y, &field.graph, options));
  }
  setThreadCount(0);
  EXPECT_EQ(results[0].statistic, results[1].statistic);
  EXPECT_EQ(results[0].extent, results[1].extent);
  EXPECT_EQ(results[0].mass, results[1].mass);
  EXPECT_EQ(results[0].tfce, results[1].tfce);
}

TEST(Permutation, IsTheSameWithAnyInstructionSet) {
  const Eigen::MatrixXd y = normalMatrix(40, 70, 36);
  PermutationOptions options;
  options.count = 50;
  const auto run = [&] {
    return permute(designOf(40), column(3, 2), y, nullptr, options).statistic;
  };
  const std::vector<float> widest = run();
  explica::testing::forEachNarrowerInstructionSet(
      [&](std::int64_t target) { EXPECT_EQ(run(), widest) << target; });
}

TEST(Permutation, PlacesWithMissingValuesAreLeftOut) {
  Eigen::MatrixXd y = normalMatrix(10, 3, 37);
  y(4, 1) = kNaN;
  PermutationOptions options;
  options.count = 50;
  const auto found = permute(designOf(10), column(3, 2), y, nullptr, options);
  EXPECT_EQ(found.observed[1], 0);
  EXPECT_TRUE(std::isnan(familyWiseP(found.statistic, found.observed)[1]));
}

/// Nothing is there: family-wise P of the data are uniform (Kolmogorov-Smirnov).
TEST(Permutation, NullDataHaveUniformP) {
  constexpr int kSets = 300;
  std::vector<double> p;
  const Design d = designOf(14);
  PermutationOptions options;
  options.count = 99;
  for (unsigned set = 0; set < kSets; ++set) {
    options.seed = set;
    const auto found = permute(d, column(3, 2), normalMatrix(14, 20, 1000 + set), nullptr, options);
    p.push_back(familyWiseP(found.statistic, found.statistic[0]));
  }
  std::sort(p.begin(), p.end());
  double distance = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double share = static_cast<double>(i + 1) / kSets;
    // P is a multiple of 0.01, at which the distribution is compared.
    if (i + 1 == p.size() || p[i + 1] > p[i] + 1e-9)
      distance = std::max(distance, std::abs(share - p[i]));
  }
  EXPECT_LT(distance, 1.63 / std::sqrt(kSets));  // P 0.01
}

/// Family-wise P of a far too large effect is as small as the number of shuffles allows.
TEST(Permutation, FindsAnEffect) {
  Eigen::MatrixXd y = normalMatrix(20, 10, 38);
  const Design d = designOf(20);
  y.col(3) += 5 * d.matrix.col(2);
  PermutationOptions options;
  options.count = 199;
  const auto found = permute(d, column(3, 2), y, nullptr, options);
  const Eigen::VectorXd p = familyWiseP(found.statistic, found.observed);
  EXPECT_NEAR(p[3], 1.0 / 200, 1e-12);
  EXPECT_GT(found.observed[3], 0);
}

}  // namespace
}  // namespace explica::statistics
