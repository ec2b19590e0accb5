// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Statistics/GroupMaps.h"

#include "Explica/Core/Types.h"
#include "Explica/Statistics/Distributions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace explica::statistics {
namespace {

/// N people x V places of normal values about 2.5 mm.
Eigen::MatrixXd people(Eigen::Index count, Eigen::Index places) {
  std::mt19937 draw(5);
  std::normal_distribution<double> thickness(2.5, 0.4);
  Eigen::MatrixXd maps(count, places);
  for (double& value : maps.reshaped()) value = thickness(draw);
  return maps;
}

GroupMaps gathered(const Eigen::MatrixXd& maps) {
  GroupMaps group(maps.cols());
  for (Eigen::Index n = 0; n < maps.rows(); ++n) group.add(maps.row(n).transpose());
  return group;
}

TEST(GroupMaps, MeanAndDeviationAreThoseOfTheMatrix) {
  const Eigen::MatrixXd maps = people(9, 40);
  const GroupMaps group = gathered(maps);
  const Eigen::RowVectorXd mean = maps.colwise().mean();
  EXPECT_LT((group.mean().transpose() - mean).norm(), 1e-12);
  const Eigen::RowVectorXd variance = (maps.rowwise() - mean).array().square().colwise().sum() / 8;
  EXPECT_LT((group.deviation().transpose().array().square().matrix() - variance).norm(), 1e-12);
}

TEST(GroupMaps, APersonIsComparedWithTheOthersOnly) {
  Eigen::MatrixXd maps = people(9, 40);
  maps.row(0).array() += 3;  // an outlier that widens the group's deviation
  const Eigen::VectorXd person = maps.row(0);
  const GroupMaps with = gathered(maps), without = gathered(maps.bottomRows(8));
  const Eigen::VectorXd z = with.distance(person, true);
  EXPECT_LT((z - without.distance(person, false)).norm() / z.norm(), 1e-10);
  EXPECT_GT(z.mean(), 4);
}

TEST(GroupMaps, DistancesAreStudentsT) {
  constexpr Eigen::Index kPlaces = 20000;
  const Eigen::MatrixXd maps = people(6, kPlaces);
  const Eigen::VectorXd z = gathered(maps).distance(maps.row(2), true);
  const double beyond = tQuantile(0.025, 4);  // of 5 others
  const auto share = static_cast<double>((z.array().abs() > beyond).count()) / kPlaces;
  EXPECT_NEAR(share, 0.05, 4 * std::sqrt(0.05 * 0.95 / kPlaces));
  EXPECT_NEAR(typicalDistance(z, 5), 1, 0.03);
}

TEST(GroupMaps, WhatIsNotKnownIsNotCounted) {
  Eigen::MatrixXd maps = people(5, 3);
  maps(1, 0) = kNaN;
  maps.col(2).setConstant(1);
  const GroupMaps group = gathered(maps);
  EXPECT_EQ(group.people()[0], 4);
  const Eigen::VectorXd z = group.distance(maps.row(1), true);
  EXPECT_TRUE(std::isnan(z[0]));
  EXPECT_TRUE(std::isfinite(z[1]));
  EXPECT_TRUE(std::isnan(z[2]));  // nobody differs there
  EXPECT_TRUE(std::isnan(gathered(maps.topRows(3)).distance(maps.row(0), true)[1]));
  EXPECT_TRUE(std::isnan(typicalDistance(Eigen::VectorXd::Constant(3, kNaN), 9)));
}

}  // namespace
}  // namespace explica::statistics
