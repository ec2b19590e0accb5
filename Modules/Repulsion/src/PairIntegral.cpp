// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Repulsion/PairIntegral.h"

#include "MovingSet.h"
#include "Quadrature.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

namespace explica::repulsion {
namespace {

/// Part of a point, segment or triangle: corners as points and as coordinates in the whole, a row
/// each; rows that a segment or point lacks are zero.
struct Simplex {
  int corners = 3;
  Eigen::Matrix3d point = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d lambda = Eigen::Matrix3d::Identity();
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  double radius = 0;  // farthest corner from the centre
  double share = 1;   // of the whole's measure

  void measure() {
    centre = point.topRows(corners).colwise().sum() / corners;
    double farthest = 0;
    for (int k = 0; k < corners; ++k) {
      farthest = std::max(farthest, (point.row(k) - centre).squaredNorm());
    }
    radius = std::sqrt(farthest);
  }
  /// Derivatives by the whole's corners from those by its own, a row each.
  [[nodiscard]] Eigen::Matrix3d inWhole(const Eigen::Matrix3d& byCorner) const {
    if (share == 1) return byCorner;
    return lambda.transpose() * byCorner;
  }
};

Simplex whole(std::initializer_list<Point> points) {
  Simplex s;
  s.corners = static_cast<int>(points.size());
  int k = 0;
  for (const Point& p : points) s.point.row(k++) = p.transpose();
  s.measure();
  return s;
}

/// The two halves, cut across the longest edge.
std::array<Simplex, 2> halves(const Simplex& s) {
  int from = 0, to = 1;
  const auto squaredLength = [&](int i, int j) {
    return (s.point.row(i) - s.point.row(j)).squaredNorm();
  };
  for (int i = 0; i < s.corners; ++i) {
    for (int j = i + 1; j < s.corners; ++j) {
      if (squaredLength(i, j) > squaredLength(from, to)) std::tie(from, to) = std::pair(i, j);
    }
  }
  std::array<Simplex, 2> parts = {s, s};
  for (int half = 0; half < 2; ++half) {
    const int moved = half == 0 ? to : from;
    parts[half].point.row(moved) = (s.point.row(from) + s.point.row(to)) / 2;
    parts[half].lambda.row(moved) = (s.lambda.row(from) + s.lambda.row(to)) / 2;
    parts[half].share /= 2;
    parts[half].measure();
  }
  return parts;
}

/// From which distance, in sums of radii, which rule is good enough.
struct Ladder {
  double three;    // degree 2
  double seven;    // degree 5
  double sixteen;  // degree 8; below it the larger simplex is halved
  int depth;       // halvings at most
};
constexpr Ladder kCoarse = {4.0, 0.9, 0.5, 12};   // relative error about 1e-3
constexpr Ladder kStandard = {14, 4.5, 2.0, 20};  // 1e-6, except needles
constexpr Ladder kFine = {200, 14, 4.0, 28};      // 1e-9

const Ladder& ladderFor(PairAccuracy accuracy) {
  switch (accuracy) {
    case PairAccuracy::Coarse:
      return kCoarse;
    case PairAccuracy::Fine:
      return kFine;
    case PairAccuracy::Standard:
      break;
  }
  return kStandard;
}

const Rule& ruleFor(int corners, double ratio, const Ladder& ladder) {
  if (corners == 1) return pointRule();
  if (ratio >= ladder.three) return corners == 2 ? segmentRule2() : triangleRule3();
  if (ratio >= ladder.seven) return corners == 2 ? segmentRule3() : triangleRule7();
  return corners == 2 ? segmentRule5() : triangleRule16();
}

/// Mean of 1/|x - y|^2 over A x B with derivatives by the corners of A and B, a row each.
struct Mean {
  double value = 0;
  Eigen::Matrix3d byA = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d byB = Eigen::Matrix3d::Zero();
};

/// Adds the mean by a product rule, with M points on B.
template <int M>
void addByRule(const Simplex& a, const Rule& ruleA, const Simplex& b, const Rule& ruleB,
               Mean& mean) {
  using Column = Eigen::Array<double, M, 1>;
  using Columns = Eigen::Array<double, M, 3>;
  const auto lambdaB = ruleB.lambda.topRows<M>();
  const Columns y = lambdaB.lazyProduct(b.point);
  const Column weight = a.share * b.share * ruleB.weight.head<M>();
  Columns onB = Columns::Zero();
  Eigen::Matrix3d byA = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < ruleA.weight.size(); ++i) {
    Columns z;
    for (int k = 0; k < 3; ++k) z.col(k) = ruleA.lambda.row(i).dot(a.point.col(k)) - y.col(k);
    const Column squared = z.col(0).square() + z.col(1).square() + z.col(2).square();
    // Zero only where faces touch and the subdivision has ended.
    const Column inverse = (squared > 0).select(squared.inverse(), 0);
    const Column term = ruleA.weight[i] * weight * inverse;
    const Column pull = -2 * term * inverse;
    mean.value += term.sum();
    for (int k = 0; k < 3; ++k) {
      const Column force = pull * z.col(k);
      byA.col(k) += force.sum() * ruleA.lambda.row(i).transpose();
      onB.col(k) -= force;
    }
  }
  const Eigen::Matrix3d byB = lambdaB.transpose().lazyProduct(onB.matrix());
  mean.byA += a.inWhole(byA);
  mean.byB += b.inWhole(byB);
}

void addMean(const Simplex& a, const Simplex& b, const Ladder& ladder, int depth, Mean& mean) {
  const double ratio = (a.centre - b.centre).norm() / (a.radius + b.radius);
  if (ratio < ladder.sixteen && depth < ladder.depth) {
    const bool cutA = a.radius >= b.radius;
    for (const Simplex& part : halves(cutA ? a : b)) {
      addMean(cutA ? part : a, cutA ? b : part, ladder, depth + 1, mean);
    }
    return;
  }
  const Rule& ruleA = ruleFor(a.corners, ratio, ladder);
  const Rule& ruleB = ruleFor(b.corners, ratio, ladder);
  switch (ruleB.weight.size()) {
    case 3:
      return addByRule<3>(a, ruleA, b, ruleB, mean);
    case 7:
      return addByRule<7>(a, ruleA, b, ruleB, mean);
    default:
      return addByRule<16>(a, ruleA, b, ruleB, mean);
  }
}

/// @param b  a triangle
Mean meanOver(const Simplex& a, const Simplex& b, PairAccuracy accuracy) {
  Mean mean;
  addMean(a, b, ladderFor(accuracy), 0, mean);
  return mean;
}

/// Multiplies a mean and its derivatives by both areas.
PairIntegral timesAreas(const Mean& mean, const Corners& s, const Corners& t) {
  const AreaGradient areaS = areaGradient(s);
  const AreaGradient areaT = areaGradient(t);
  const double product = areaS.area * areaT.area;
  PairIntegral result;
  result.value = product * mean.value;
  for (int k = 0; k < 3; ++k) {
    result.byS[k] =
        product * mean.byA.row(k).transpose() + mean.value * areaT.area * areaS.byCorner[k];
    result.byT[k] =
        product * mean.byB.row(k).transpose() + mean.value * areaS.area * areaT.byCorner[k];
  }
  return result;
}

}  // namespace

PairIntegral integrateApart(const Corners& s, const Corners& t, PairAccuracy accuracy) {
  return timesAreas(meanOver(whole({s[0], s[1], s[2]}), whole({t[0], t[1], t[2]}), accuracy), s, t);
}

PairIntegral integrateVertexSharing(const Corners& s, const Corners& t, PairAccuracy accuracy) {
  const Mean edgeS = meanOver(whole({s[1], s[2]}), whole({t[0], t[1], t[2]}), accuracy);
  const Mean edgeT = meanOver(whole({t[1], t[2]}), whole({s[0], s[1], s[2]}), accuracy);
  Mean mean{edgeS.value + edgeT.value, edgeT.byB, edgeS.byB};
  mean.byA.bottomRows(2) += edgeS.byA.topRows(2);
  mean.byB.bottomRows(2) += edgeT.byA.topRows(2);
  return timesAreas(mean, s, t);
}

PairIntegral integrateEdgeSharing(const Corners& s, const Corners& t, PairAccuracy accuracy) {
  // Corners of the six triangles, a row each, as multiples of e, a and b.
  static const auto kTriangles = [] {
    const Eigen::RowVector3d e(1, 0, 0), a(0, 1, 0), b(0, 0, 1);
    std::array<Eigen::Matrix3d, 6> triangles;
    triangles[0] << a, e, e - b;
    triangles[1] << a, e - b, a - b;
    triangles[2] << -b, e - b, a - b;
    triangles[3] << -b, -e, a - e;
    triangles[4] << -b, a - e, a - b;
    triangles[5] << a, a - e, a - b;
    return triangles;
  }();
  Eigen::Matrix3d sides;
  sides << (s[1] - s[0]).transpose(), (s[2] - s[0]).transpose(), (t[2] - s[0]).transpose();
  const Simplex origin = whole({Point::Zero()});
  double value = 0;
  Eigen::Matrix3d bySides = Eigen::Matrix3d::Zero();
  for (const Eigen::Matrix3d& triangle : kTriangles) {
    const Eigen::Matrix3d corners = triangle * sides;
    const Mean part =
        meanOver(origin, whole({corners.row(0), corners.row(1), corners.row(2)}), accuracy);
    value += part.value;
    bySides += triangle.transpose() * part.byB;
  }
  Mean mean;
  mean.value = value;
  mean.byA << -bySides.colwise().sum(), bySides.row(0), bySides.row(1);
  mean.byB.row(2) = bySides.row(2);
  return timesAreas(mean, s, t);
}

}  // namespace explica::repulsion
