// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Statistics/Combat.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Types.h"
#include "RandomNumbers.h"

#include <gtest/gtest.h>

namespace explica::statistics {
namespace {

struct Sites {
  Eigen::MatrixXd values, age;
  std::vector<int> site;
};

/// Two sites, the second with half of a unit more and twice the spread; age is older there.
Sites simulated(Eigen::Index people, Eigen::Index places) {
  Sites s{testing::normalMatrix(people, places, 21), testing::normalMatrix(people, 1, 22), {}};
  for (Eigen::Index i = 0; i < people; ++i) {
    const int site = i < people / 2 ? 0 : 1;
    s.site.push_back(site);
    s.age(i, 0) += site;
    if (site == 1) s.values.row(i) = 2 * s.values.row(i).array() + 0.5;
    s.values.row(i).array() += 2.5 - 0.7 * s.age(i, 0);
  }
  return s;
}

double slope(const Eigen::VectorXd& y, const Eigen::VectorXd& x) {
  const Eigen::VectorXd a = x.array() - x.mean();
  return a.dot(y) / a.squaredNorm();
}

TEST(Combat, TakesOffSitesAndKeepsCovariates) {
  Sites s = simulated(200, 40);
  const CombatResult result = combat(s.values, s.age, s.site);
  double kept = 0, difference = 0, first = 0, second = 0;
  for (Eigen::Index v = 0; v < 40; ++v) {
    kept += slope(s.values.col(v), s.age.col(0)) / 40;
    const Eigen::VectorXd rest = s.values.col(v) + 0.7 * s.age.col(0);
    difference += (rest.tail(100).mean() - rest.head(100).mean()) / 40;
    first += (rest.head(100).array() - rest.head(100).mean()).square().sum() / 99 / 40;
    second += (rest.tail(100).array() - rest.tail(100).mean()).square().sum() / 99 / 40;
  }
  EXPECT_NEAR(kept, -0.7, 0.03);
  EXPECT_NEAR(difference, 0, 0.02);
  EXPECT_NEAR(second / first, 1, 0.05);
  EXPECT_NEAR(result.scale.row(1).mean() / result.scale.row(0).mean(), 2, 0.1);
}

TEST(Combat, AgreesWithAnIndependentImplementation) {
  // Numbers of Johnson's equations solved by numpy for these values: six people, three places.
  Eigen::MatrixXd y(6, 3);
  y << 2.1, 3.0, 1.2, 2.5, 3.3, 1.9, 1.9, 2.7, 1.4, 3.1, 4.4, 2.0, 3.6, 3.9, 3.3, 2.8, 4.9, 2.6;
  combat(y, Eigen::MatrixXd(6, 0), {0, 0, 0, 1, 1, 1});
  Eigen::MatrixXd theirs(6, 3);
  theirs << 2.5930989238, 3.6087971281, 1.8577413064, 3.0260826419, 3.9354218969, 2.6217520171,
      2.3766070647, 3.2821723592, 2.0760300809, 2.6220517395, 3.7721955552, 1.5389989534,
      2.9650186285, 3.4295415247, 2.4297263034, 2.4162716062, 4.1148495857, 1.9501038842;
  for (Eigen::Index i = 0; i < 6; ++i) {
    for (Eigen::Index v = 0; v < 3; ++v) EXPECT_NEAR(y(i, v), theirs(i, v), 1e-6);
  }
}

TEST(Combat, LeavesPlacesWithMissingValuesAsTheyAre) {
  Sites s = simulated(20, 5);
  s.values(3, 2) = kNaN;
  const Eigen::VectorXd before = s.values.col(2);
  combat(s.values, s.age, s.site);
  EXPECT_EQ(before.tail(16), s.values.col(2).tail(16));
}

TEST(Combat, RefusesASiteOfOnePerson) {
  Sites s = simulated(20, 5);
  s.site.back() = 2;
  EXPECT_THROW(combat(s.values, s.age, s.site), InvalidInput);
}

}  // namespace
}  // namespace explica::statistics
