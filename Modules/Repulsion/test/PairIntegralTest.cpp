// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Repulsion/PairIntegral.h"

#include "Explica/Testing/TaylorRemainder.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <functional>
#include <vector>

namespace explica::repulsion {
namespace {

using Integrate = PairIntegral (*)(const Corners&, const Corners&, PairAccuracy);

const Corners kS = {Point(0, 0, 0), Point(1, 0.1, 0), Point(0.3, 0.9, 0.2)};

/// The four similar quarters of a triangle; quarter k < 3 keeps corner k.
std::array<Corners, 4> quarters(const Corners& c) {
  const Point ab = (c[0] + c[1]) / 2;
  const Point bc = (c[1] + c[2]) / 2;
  const Point ca = (c[2] + c[0]) / 2;
  return {Corners{c[0], ab, ca}, Corners{ab, c[1], bc}, Corners{ca, bc, c[2]}, Corners{ab, bc, ca}};
}

int commonCorners(const Corners& s, const Corners& t, Corners& sFirst, Corners& tFirst) {
  std::vector<int> common;
  std::vector<int> restS;
  std::array<bool, 3> used{};
  int n = 0;
  for (int i = 0; i < 3; ++i) {
    bool found = false;
    for (int j = 0; j < 3; ++j) {
      if ((s[i] - t[j]).norm() < 1e-12) {
        sFirst[n] = s[i];
        tFirst[n++] = t[j];
        used[j] = found = true;
      }
    }
    if (!found) restS.push_back(i);
  }
  int m = n;
  for (const int i : restS) sFirst[m++] = s[i];
  m = n;
  for (int j = 0; j < 3; ++j) {
    if (!used[j]) tFirst[m++] = t[j];
  }
  return n;
}

/// The value of a pair from its sixteen pairs of quarters: no formula of the whole pair enters.
double byQuarters(const Corners& s, const Corners& t) {
  double sum = 0;
  for (const Corners& qs : quarters(s)) {
    for (const Corners& qt : quarters(t)) {
      Corners a;
      Corners b;
      switch (commonCorners(qs, qt, a, b)) {
        case 0:
          sum += integrateApart(qs, qt, PairAccuracy::Fine).value;
          break;
        case 1:
          sum += integrateVertexSharing(a, b, PairAccuracy::Fine).value;
          break;
        default:
          sum += integrateEdgeSharing(a, b, PairAccuracy::Fine).value;
          break;
      }
    }
  }
  return sum;
}

/// I(vertex sharing) = 4/3 of its fifteen pairs of quarters that do not touch: by similarity the
/// sixteenth is I/4, so that only integrals without singularity remain.
double vertexSharingByRegularPairs(const Corners& s, const Corners& t) {
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      if (i == 0 && j == 0) continue;
      sum += integrateApart(quarters(s)[i], quarters(t)[j], PairAccuracy::Fine).value;
    }
  }
  return sum * 4 / 3;
}

/// Two of the sixteen pairs of quarters are similar to the whole (each I/4), the others share a
/// corner or nothing: I = 2 * (sum of these).
double edgeSharingByLesserPairs(const Corners& s, const Corners& t) {
  double sum = 0;
  for (const Corners& qs : quarters(s)) {
    for (const Corners& qt : quarters(t)) {
      Corners a;
      Corners b;
      const int common = commonCorners(qs, qt, a, b);
      if (common == 1) sum += vertexSharingByRegularPairs(a, b);
      if (common == 0) sum += integrateApart(qs, qt, PairAccuracy::Fine).value;
    }
  }
  return 2 * sum;
}

TEST(PairIntegral, VertexSharingEqualsWhatItsRegularPartsSayBySimilarity) {
  for (const double angleRad : {0.3, 1.2, 2.5}) {
    const Eigen::AngleAxisd turn(angleRad, Vector(1, -0.2, 0.4).normalized());
    const Corners t = {kS[0], turn * Point(-0.8, 0.3, 0.5), turn * Point(-0.2, -0.9, 0.1)};
    const double truth = vertexSharingByRegularPairs(kS, t);
    EXPECT_NEAR(integrateVertexSharing(kS, t, PairAccuracy::Fine).value, truth, 1e-8 * truth);
    EXPECT_NEAR(integrateVertexSharing(kS, t).value, truth, 1e-5 * truth);
  }
}

TEST(PairIntegral, EdgeSharingEqualsWhatItsLesserPartsSayBySimilarity) {
  for (const Point& apex : {Point(0.4, -0.8, 0.1), Point(0.6, -0.1, 0.9), Point(0.2, 0.5, 0.7)}) {
    const Corners t = {kS[0], kS[1], apex};
    const double truth = edgeSharingByLesserPairs(kS, t);
    EXPECT_NEAR(integrateEdgeSharing(kS, t, PairAccuracy::Fine).value, truth, 1e-8 * truth);
    EXPECT_NEAR(integrateEdgeSharing(kS, t).value, truth, 1e-5 * truth);
  }
}

TEST(PairIntegral, AddsUpOverParts) {
  const Corners t = {Point(0.2, 0.3, 0.4), Point(1.1, 0.2, 0.5), Point(0.4, 1.1, 0.9)};
  const double value = integrateApart(kS, t, PairAccuracy::Fine).value;
  EXPECT_NEAR(byQuarters(kS, t), value, 1e-9 * value);
}

TEST(PairIntegral, GradientsPassTheTaylorTest) {
  struct Case {
    Integrate integrate;
    Corners t;
    int shared;
  };
  const std::vector<Case> cases = {
      {&integrateApart, {Point(0.2, 0.3, 0.5), Point(1.1, 0.2, 0.5), Point(0.4, 1.1, 0.9)}, 0},
      {&integrateApart, {Point(4, 3, 5), Point(5, 3.1, 5), Point(4.2, 4, 5.5)}, 0},
      {&integrateVertexSharing, {kS[0], Point(-0.8, 0.3, 0.5), Point(-0.2, -0.9, 0.1)}, 1},
      {&integrateEdgeSharing, {kS[0], kS[1], Point(0.4, -0.8, 0.4)}, 2},
      {&integrateEdgeSharing, {kS[0], kS[1], Point(0.3, 0.6, 0.7)}, 2}};
  for (const Case& c : cases) {
    // Rows: corners of S, then those of T that S has not.
    Positions at(6 - c.shared, 3);
    for (int k = 0; k < 3; ++k) at.row(k) = kS[k].transpose();
    for (int k = c.shared; k < 3; ++k) at.row(3 + k - c.shared) = c.t[k].transpose();
    const auto cornersS = [](const Positions& x) {
      return Corners{x.row(0).transpose(), x.row(1).transpose(), x.row(2).transpose()};
    };
    const auto cornersT = [&](const Positions& x) {
      Corners t;
      for (int k = 0; k < 3; ++k) t[k] = x.row(k < c.shared ? k : 3 + k - c.shared).transpose();
      return t;
    };
    const auto energy = [&](const Positions& x) {
      return c.integrate(cornersS(x), cornersT(x), PairAccuracy::Standard).value;
    };
    const PairIntegral pair = c.integrate(kS, c.t, PairAccuracy::Standard);
    Positions gradient = Positions::Zero(6 - c.shared, 3);
    for (int k = 0; k < 3; ++k) {
      gradient.row(k) += pair.byS[k].transpose();
      gradient.row(k < c.shared ? k : 3 + k - c.shared) += pair.byT[k].transpose();
    }
    EXPECT_NEAR(pair.value, energy(at), 1e-14);
    EXPECT_NEAR(test::taylorSlope(energy, at, gradient, 1e-4), 2, 0.15) << c.shared;
  }
}

TEST(PairIntegral, DerivativeOfSharedCornersNeedsTheOtherFacesOwnCorners) {
  // Erratum 5: the last denominators' b and c in Eq. 5.44 are corners of face j.  Moving the common
  // corner changes the area of T by the edge (c^ - b^) of T.
  const Corners t = {kS[0], Point(-0.8, 0.3, 0.5), Point(-0.2, -0.9, 0.1)};
  const PairIntegral pair = integrateVertexSharing(kS, t);
  const Vector byCommon = pair.byS[0] + pair.byT[0];
  for (int axis = 0; axis < 3; ++axis) {
    const double step = 1e-5;
    const auto at = [&](double e) {
      Corners s2 = kS;
      Corners t2 = t;
      s2[0][axis] += e;
      t2[0][axis] += e;
      return integrateVertexSharing(s2, t2).value;
    };
    EXPECT_NEAR((at(step) - at(-step)) / (2 * step), byCommon[axis], 1e-5);
  }
}

TEST(PairIntegral, ScalesWithTheSquareOfTheSize) {
  const Corners t = {kS[0], kS[1], Point(0.4, -0.8, 0.4)};
  Corners s4 = kS;
  Corners t4 = t;
  for (int k = 0; k < 3; ++k) {
    s4[k] *= 4;
    t4[k] *= 4;
  }
  EXPECT_EQ(integrateEdgeSharing(s4, t4).value, 16 * integrateEdgeSharing(kS, t).value);
}

TEST(PairIntegral, StaysFiniteAtContact) {
  // A corner on the face, and an edge across an edge.
  const Corners touching = {(kS[0] + kS[1] + kS[2]) / 3, Point(0.5, 0.4, 1), Point(0.2, 0.3, 1)};
  const Corners crossing = {Point(0.5, -1, 0.05), Point(0.5, 1, 0.05), Point(0.5, 0, 1)};
  for (const Corners& t : {touching, crossing}) {
    const PairIntegral pair = integrateApart(kS, t);
    EXPECT_TRUE(std::isfinite(pair.value));
    for (const Vector& g : pair.byS) EXPECT_TRUE(g.allFinite());
  }
}

}  // namespace
}  // namespace explica::repulsion
