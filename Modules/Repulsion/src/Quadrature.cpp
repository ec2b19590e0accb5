// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Quadrature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <utility>
#include <vector>

namespace explica::repulsion {
namespace {

/// Orbit of a rule under the triangle's symmetries: (a, b, 1 - a - b) with its distinct
/// permutations.
struct Orbit {
  double a;
  double b;
  double weight;
};

Rule fromPoints(const std::vector<std::array<double, 4>>& lambdaAndWeight) {
  Rule rule;
  const auto count = static_cast<Eigen::Index>(lambdaAndWeight.size());
  rule.lambda.resize(count, 3);
  rule.weight.resize(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& [a, b, c, weight] = lambdaAndWeight[i];
    rule.lambda.row(i) << a, b, c;
    rule.weight[i] = weight;
  }
  return rule;
}

Rule onTriangle(std::initializer_list<Orbit> orbits) {
  std::vector<std::array<double, 4>> points;
  for (const auto& [a, b, weight] : orbits) {
    std::array<double, 3> lambda = {a, b, 1 - a - b};
    if (a == b && std::abs(b - lambda[2]) < 1e-12) lambda[2] = a;  // the centroid
    std::ranges::sort(lambda);
    do {
      points.push_back({lambda[0], lambda[1], lambda[2], weight});
    } while (std::ranges::next_permutation(lambda).found);
  }
  return fromPoints(points);
}

Rule onSegment(std::initializer_list<std::pair<double, double>> nodesAndWeights) {
  std::vector<std::array<double, 4>> points;
  for (const auto& [node, weight] : nodesAndWeights) {
    points.push_back({(1 - node) / 2, (1 + node) / 2, 0, weight / 2});
  }
  return fromPoints(points);
}

}  // namespace

const Rule& triangleRule3() {
  static const Rule rule = onTriangle({{1.0 / 6, 1.0 / 6, 1.0 / 3}});
  return rule;
}

const Rule& triangleRule7() {
  static const Rule rule = onTriangle({{0.470142064105115, 0.470142064105115, 0.132394152788506},
                                       {0.101286507323456, 0.101286507323456, 0.125939180544827},
                                       {1.0 / 3, 1.0 / 3, 0.225}});
  return rule;
}

const Rule& triangleRule16() {
  static const Rule rule = onTriangle({{0.459292588292723, 0.459292588292723, 0.095091634267285},
                                       {0.170569307751760, 0.170569307751760, 0.103217370534718},
                                       {0.050547228317031, 0.050547228317031, 0.032458497623198},
                                       {0.008394777409958, 0.263112829634638, 0.027230314174435},
                                       {1.0 / 3, 1.0 / 3, 0.144315607677787}});
  return rule;
}

const Rule& segmentRule2() {
  static const Rule rule = onSegment({{-0.577350269189625764509, 1}, {0.577350269189625764509, 1}});
  return rule;
}

const Rule& segmentRule3() {
  static const Rule rule = onSegment(
      {{-0.774596669241483377036, 5.0 / 9}, {0, 8.0 / 9}, {0.774596669241483377036, 5.0 / 9}});
  return rule;
}

const Rule& segmentRule5() {
  static const Rule rule = onSegment({{-0.906179845938663992798, 0.236926885056189087514},
                                      {-0.538469310105683091036, 0.478628670499366468041},
                                      {0, 0.568888888888888888889},
                                      {0.538469310105683091036, 0.478628670499366468041},
                                      {0.906179845938663992798, 0.236926885056189087514}});
  return rule;
}

const Rule& pointRule() {
  static const Rule rule = fromPoints({{1, 0, 0, 1}});
  return rule;
}

}  // namespace explica::repulsion
