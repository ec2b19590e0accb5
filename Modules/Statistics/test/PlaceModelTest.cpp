// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Types.h"
#include "Explica/Statistics/Distributions.h"
#include "Explica/Statistics/FalseDiscovery.h"
#include "Explica/Statistics/PlaceModel.h"
#include "RandomNumbers.h"

#include <gtest/gtest.h>

namespace explica::statistics {
namespace {

using testing::normalMatrix;

/// Two groups of `n` people with an intercept.
Design twoGroups(Eigen::Index n) {
  Design d;
  d.matrix = Eigen::MatrixXd::Ones(2 * n, 2);
  d.matrix.col(1).head(n).setZero();
  d.columns = {"intercept", "group[b]"};
  return d;
}

Contrast second(const Design& d) {
  return {"c", "c", Eigen::VectorXd::Unit(d.matrix.cols(), 1)};
}

TEST(PlaceModel, TwoGroupsAreStudentsTest) {
  const Design d = twoGroups(7);
  const Eigen::MatrixXd y = normalMatrix(14, 5, 1).array() + 2.5;
  ModelMaps maps(2, 5, 1);
  fitPlaces(d, {second(d)}, y, 0, maps);
  for (Eigen::Index v = 0; v < 5; ++v) {
    const Eigen::VectorXd a = y.col(v).head(7), b = y.col(v).tail(7);
    const double pooled =
        ((a.array() - a.mean()).square().sum() + (b.array() - b.mean()).square().sum()) / 12;
    const double t = (b.mean() - a.mean()) / std::sqrt(pooled * 2 / 7);
    const ContrastMaps& c = maps.contrasts[0];
    EXPECT_NEAR(c.statistic[v], t, 1e-12);
    EXPECT_NEAR(c.effect[v], b.mean() - a.mean(), 1e-12);
    EXPECT_EQ(c.df[v], 12);
    EXPECT_NEAR(c.p[v], tTwoSided(t, 12), 1e-12);
    EXPECT_NEAR(standardisedEffect(c, maps.variance)[v], (b.mean() - a.mean()) / std::sqrt(pooled),
                1e-12);
    EXPECT_NEAR(confidenceHalfWidth(c, 0.95)[v], 2.178812829663418 * c.error[v], 1e-9);
  }
}

TEST(PlaceModel, FOfSeveralGroupsIsTheAnalysisOfVariance) {
  Design d;
  d.matrix = Eigen::MatrixXd::Zero(12, 3);
  d.matrix.col(0).setOnes();
  d.matrix.col(1).segment(4, 4).setOnes();
  d.matrix.col(2).tail(4).setOnes();
  const Contrast f{"f", "f", Eigen::MatrixXd::Identity(3, 3).rightCols(2)};
  const Eigen::MatrixXd y = normalMatrix(12, 1, 2);
  ModelMaps maps(3, 1, 1);
  fitPlaces(d, {f}, y, 0, maps);
  double between = 0, within = 0;
  for (int g = 0; g < 3; ++g) {
    const Eigen::VectorXd part = y.col(0).segment(4 * g, 4);
    between += 4 * std::pow(part.mean() - y.mean(), 2);
    within += (part.array() - part.mean()).square().sum();
  }
  EXPECT_NEAR(maps.contrasts[0].statistic[0], between / 2 / (within / 9), 1e-11);
  EXPECT_NEAR(maps.contrasts[0].effect[0], between / (between + within), 1e-12);
}

TEST(PlaceModel, PartialCorrelationIsThatOfResiduals) {
  Design d;
  d.matrix = normalMatrix(30, 4, 3);
  d.matrix.col(0).setOnes();
  const Eigen::MatrixXd y = normalMatrix(30, 1, 4);
  ModelMaps maps(4, 1, 1);
  fitPlaces(d, {second(d)}, y, 0, maps);
  Eigen::MatrixXd rest(30, 3);
  rest << d.matrix.col(0), d.matrix.rightCols(2);
  const auto residual = [&](const Eigen::VectorXd& v) {
    return Eigen::VectorXd(v - rest * (rest.transpose() * rest).inverse() * rest.transpose() * v);
  };
  const Eigen::VectorXd a = residual(d.matrix.col(1)), b = residual(y.col(0));
  EXPECT_NEAR(partialCorrelation(maps.contrasts[0])[0], a.dot(b) / a.norm() / b.norm(), 1e-12);
}

TEST(PlaceModel, APlaceWithoutSomePeopleIsFittedToTheOthers) {
  const Design d = twoGroups(8);
  Eigen::MatrixXd y = normalMatrix(16, 2, 5);
  y(3, 1) = kNaN;
  y(12, 1) = kNaN;
  ModelMaps maps(2, 2, 1), alone(2, 1, 1);
  fitPlaces(d, {second(d)}, y, 0, maps);
  Design fewer = twoGroups(7);
  Eigen::MatrixXd rest(14, 1);
  for (Eigen::Index i = 0, k = 0; i < 16; ++i) {
    if (i != 3 && i != 12) rest(k++, 0) = y(i, 1);
  }
  fitPlaces(fewer, {second(fewer)}, rest, 0, alone);
  EXPECT_EQ(maps.people[1], 14);
  EXPECT_EQ(maps.contrasts[0].df[1], 12);
  EXPECT_NEAR(maps.contrasts[0].statistic[1], alone.contrasts[0].statistic[0], 1e-12);
}

TEST(PlaceModel, APlaceWhereAGroupIsMissingHasNoEffect) {
  const Design d = twoGroups(4);
  Eigen::MatrixXd y = normalMatrix(8, 1, 6);
  y.topRows(4).setConstant(kNaN);
  ModelMaps maps(2, 1, 1);
  fitPlaces(d, {second(d)}, y, 0, maps);
  EXPECT_TRUE(std::isnan(maps.contrasts[0].statistic[0]));
}

/// A balanced layout: restricted likelihood gives the variances of the analysis of variance.
TEST(PlaceModel, RandomInterceptsOfABalancedLayoutHaveAClosedForm) {
  constexpr Eigen::Index kGroups = 12, kEach = 3, n = kGroups * kEach;
  Design d;
  d.matrix = Eigen::MatrixXd::Ones(n, 2);
  Eigen::MatrixXd y = normalMatrix(n, 1, 7);
  const Eigen::MatrixXd own = normalMatrix(kGroups, 1, 8);
  for (Eigen::Index i = 0; i < n; ++i) {
    d.groups.push_back(static_cast<int>(i / kEach));
    d.matrix(i, 1) = static_cast<double>(i % kEach) - 1;  // varies within groups
    y(i, 0) += 2 * own(i / kEach, 0);
  }
  ModelMaps maps(2, 1, 2);
  fitPlaces(d, {{"mean", "", Eigen::Vector2d(1, 0)}, {"time", "", Eigen::Vector2d(0, 1)}}, y, 0,
            maps);
  const double slope = d.matrix.col(1).dot(y.col(0)) / d.matrix.col(1).squaredNorm();
  const Eigen::VectorXd r = y.col(0) - slope * d.matrix.col(1);
  double within = 0, between = 0;
  for (Eigen::Index g = 0; g < kGroups; ++g) {
    const Eigen::VectorXd part = r.segment(kEach * g, kEach);
    within += (part.array() - part.mean()).square().sum();
    between += kEach * std::pow(part.mean() - r.mean(), 2);
  }
  const double residual = within / (n - kGroups - 1), groups = between / (kGroups - 1);
  EXPECT_NEAR(maps.variance[0], residual, 1e-6 * residual);
  EXPECT_NEAR(maps.ratio[0], (groups - residual) / kEach / residual, 1e-5);
  EXPECT_NEAR(maps.contrasts[0].error[0], std::sqrt(groups / n), 1e-6);
  EXPECT_EQ(maps.contrasts[0].df[0], kGroups - 1);
  EXPECT_NEAR(maps.contrasts[1].error[0], std::sqrt(residual / d.matrix.col(1).squaredNorm()),
              1e-6);
  EXPECT_EQ(maps.contrasts[1].df[0], n - kGroups - 1);
}

TEST(PlaceModel, GroupsThatDoNotDifferHaveNoVariance) {
  Design d;
  d.matrix = Eigen::MatrixXd::Ones(8, 1);
  d.groups = {0, 0, 1, 1, 2, 2, 3, 3};
  Eigen::MatrixXd y(8, 1);
  y << 1, -1, 1, -1, 1, -1, 1, -1;
  ModelMaps maps(1, 1, 1);
  fitPlaces(d, {{"mean", "", Eigen::VectorXd::Ones(1)}}, y, 0, maps);
  EXPECT_EQ(maps.ratio[0], 0);
}

TEST(FalseDiscoveryRate, OfFourValues) {
  Eigen::VectorXd p(5);
  p << 0.04, 0.01, kNaN, 0.02, 0.9;
  const Eigen::VectorXd q = falseDiscoveryRate(p);
  EXPECT_NEAR(q[1], 0.04, 1e-15);
  EXPECT_NEAR(q[3], 0.04, 1e-15);
  EXPECT_NEAR(q[0], 0.04 * 4 / 3, 1e-15);
  EXPECT_NEAR(q[4], 0.9, 1e-15);
  EXPECT_TRUE(std::isnan(q[2]));
}

}  // namespace
}  // namespace explica::statistics
