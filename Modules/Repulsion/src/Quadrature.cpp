// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Quadrature.h"

#include <cstddef>
#include <initializer_list>

namespace explica::repulsion {
namespace {

/// Orbit of a rule under the triangle's symmetries: (a, b, 1 - a - b) with its distinct
/// permutations.
struct Orbit {
  double a;
  double b;
  double weight;
};

template <std::size_t N>
std::array<RulePoint, N> fromOrbits(std::initializer_list<Orbit> orbits) {
  std::array<RulePoint, N> points{};
  std::size_t n = 0;
  for (const Orbit& o : orbits) {
    const double c = 1 - o.a - o.b;
    if (o.a == o.b && n + 1 == N) {
      points[n++] = {{o.a, o.b, c}, o.weight};  // the centroid comes last
    } else if (o.a == o.b) {
      points[n++] = {{c, o.a, o.a}, o.weight};
      points[n++] = {{o.a, c, o.a}, o.weight};
      points[n++] = {{o.a, o.a, c}, o.weight};
    } else {
      points[n++] = {{o.a, o.b, c}, o.weight};
      points[n++] = {{o.b, c, o.a}, o.weight};
      points[n++] = {{c, o.a, o.b}, o.weight};
      points[n++] = {{o.b, o.a, c}, o.weight};
      points[n++] = {{o.a, c, o.b}, o.weight};
      points[n++] = {{c, o.b, o.a}, o.weight};
    }
  }
  return points;
}

template <std::size_t N>
std::array<RulePoint, N> onSegment(const std::array<double, N>& node,
                                   const std::array<double, N>& weight) {
  std::array<RulePoint, N> points{};
  for (std::size_t i = 0; i < N; ++i) {
    points[i] = {{(1 - node[i]) / 2, (1 + node[i]) / 2, 0}, weight[i] / 2};
  }
  return points;
}

}  // namespace

Rule triangleRule3() {
  static const auto rule = fromOrbits<3>({{1.0 / 6, 1.0 / 6, 1.0 / 3}});
  return rule;
}

Rule triangleRule7() {
  static const auto rule = fromOrbits<7>({{0.470142064105115, 0.470142064105115, 0.132394152788506},
                                          {0.101286507323456, 0.101286507323456, 0.125939180544827},
                                          {1.0 / 3, 1.0 / 3, 0.225}});
  return rule;
}

Rule triangleRule12() {
  static const auto rule =
      fromOrbits<12>({{0.249286745170910, 0.249286745170910, 0.116786275726379},
                      {0.063089014491502, 0.063089014491502, 0.050844906370207},
                      {0.053145049844817, 0.310352451033784, 0.082851075618374}});
  return rule;
}

Rule triangleRule16() {
  static const auto rule =
      fromOrbits<16>({{0.459292588292723, 0.459292588292723, 0.095091634267285},
                      {0.170569307751760, 0.170569307751760, 0.103217370534718},
                      {0.050547228317031, 0.050547228317031, 0.032458497623198},
                      {0.008394777409958, 0.263112829634638, 0.027230314174435},
                      {1.0 / 3, 1.0 / 3, 0.144315607677787}});
  return rule;
}

Rule segmentRule2() {
  static const auto rule =
      onSegment<2>({-0.577350269189625764509, 0.577350269189625764509}, {1, 1});
  return rule;
}

Rule segmentRule3() {
  static const auto rule = onSegment<3>({-0.774596669241483377036, 0, 0.774596669241483377036},
                                        {5.0 / 9, 8.0 / 9, 5.0 / 9});
  return rule;
}

Rule segmentRule5() {
  static const auto rule =
      onSegment<5>({-0.906179845938663992798, -0.538469310105683091036, 0, 0.538469310105683091036,
                    0.906179845938663992798},
                   {0.236926885056189087514, 0.478628670499366468041, 0.568888888888888888889,
                    0.478628670499366468041, 0.236926885056189087514});
  return rule;
}

Rule pointRule() {
  static constexpr std::array<RulePoint, 1> rule = {{{{1, 0, 0}, 1}}};
  return rule;
}

}  // namespace explica::repulsion
