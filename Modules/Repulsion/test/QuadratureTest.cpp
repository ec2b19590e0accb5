// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "../src/Quadrature.h"

#include <gtest/gtest.h>

#include <cmath>

namespace explica::repulsion {
namespace {

double factorial(int n) {
  return std::tgamma(n + 1.0);
}

/// Largest error of the means of u^i v^j, i + j <= degree; exactly 2 i! j! / (i + j + 2)!.
double triangleError(const Rule& rule, int degree) {
  double worst = 0;
  for (int i = 0; i <= degree; ++i) {
    for (int j = 0; i + j <= degree; ++j) {
      double mean = 0;
      for (Eigen::Index n = 0; n < rule.weight.size(); ++n) {
        mean += rule.weight[n] * std::pow(rule.lambda(n, 1), i) * std::pow(rule.lambda(n, 2), j);
      }
      worst =
          std::max(worst, std::abs(mean - 2 * factorial(i) * factorial(j) / factorial(i + j + 2)));
    }
  }
  return worst;
}

double segmentError(const Rule& rule, int degree) {
  double worst = 0;
  for (int i = 0; i <= degree; ++i) {
    double mean = 0;
    for (Eigen::Index n = 0; n < rule.weight.size(); ++n) {
      mean += rule.weight[n] * std::pow(rule.lambda(n, 1), i);
    }
    worst = std::max(worst, std::abs(mean - 1.0 / (i + 1)));
  }
  return worst;
}

TEST(Quadrature, TriangleRulesAreExactToTheirDegreeAndNoFurther) {
  const std::array<std::pair<Rule, int>, 3> rules = {
      {{triangleRule3(), 2}, {triangleRule7(), 5}, {triangleRule16(), 8}}};
  for (const auto& [rule, degree] : rules) {
    EXPECT_LT(triangleError(rule, degree), 1e-14) << degree;
    EXPECT_GT(triangleError(rule, degree + 1), 1e-9) << degree;
  }
}

TEST(Quadrature, SegmentRulesAreExactToTheirDegreeAndNoFurther) {
  const std::array<std::pair<Rule, int>, 3> rules = {
      {{segmentRule2(), 3}, {segmentRule3(), 5}, {segmentRule5(), 9}}};
  for (const auto& [rule, degree] : rules) {
    EXPECT_LT(segmentError(rule, degree), 1e-15) << degree;
    EXPECT_GT(segmentError(rule, degree + 1), 1e-7) << degree;
  }
}

}  // namespace
}  // namespace explica::repulsion
