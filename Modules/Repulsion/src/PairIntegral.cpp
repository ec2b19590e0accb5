// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Repulsion/PairIntegral.h"

#include "MovingSet.h"
#include "Quadrature.h"

#include <algorithm>

namespace explica::repulsion {
namespace {

/// Part of a point, segment or triangle: corners as points and as coordinates in the whole.
struct Simplex {
  int corners = 3;
  std::array<Point, 3> point;
  std::array<Vector, 3> lambda;
  Point centre;
  double radius = 0;  // farthest corner from the centre
  double share = 1;   // of the whole's measure

  void measure() {
    centre.setZero();
    for (int k = 0; k < corners; ++k) centre += point[k];
    centre /= corners;
    radius = 0;
    for (int k = 0; k < corners; ++k) radius = std::max(radius, (point[k] - centre).norm());
  }
};

Simplex whole(std::initializer_list<Point> points) {
  Simplex s;
  s.corners = static_cast<int>(points.size());
  int k = 0;
  for (const Point& p : points) {
    s.point[k] = p;
    s.lambda[k] = Vector::Unit(k);
    ++k;
  }
  s.measure();
  return s;
}

/// The two halves, cut across the longest edge.
std::array<Simplex, 2> halves(const Simplex& s) {
  int from = 0;
  int to = 1;
  for (int i = 0; i < s.corners; ++i) {
    for (int j = i + 1; j < s.corners; ++j) {
      if ((s.point[i] - s.point[j]).squaredNorm() > (s.point[from] - s.point[to]).squaredNorm()) {
        from = i;
        to = j;
      }
    }
  }
  const Point middle = (s.point[from] + s.point[to]) / 2;
  const Vector lambda = (s.lambda[from] + s.lambda[to]) / 2;
  std::array<Simplex, 2> parts = {s, s};
  parts[0].point[to] = middle;
  parts[0].lambda[to] = lambda;
  parts[1].point[from] = middle;
  parts[1].lambda[from] = lambda;
  for (Simplex& part : parts) {
    part.share /= 2;
    part.measure();
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
constexpr Ladder kCoarse = {4.0, 1.0, 0.6, 12};   // relative error about 1e-3
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

Rule ruleFor(int corners, double ratio, const Ladder& ladder) {
  if (corners == 1) return pointRule();
  if (ratio >= ladder.three) return corners == 2 ? segmentRule2() : triangleRule3();
  if (ratio >= ladder.seven) return corners == 2 ? segmentRule3() : triangleRule7();
  return corners == 2 ? segmentRule5() : triangleRule16();
}

/// Mean of 1/|x - y|^2 over A x B with derivatives by the corners of A and B.
struct Mean {
  double value = 0;
  std::array<Vector, 3> byA{Vector::Zero(), Vector::Zero(), Vector::Zero()};
  std::array<Vector, 3> byB{Vector::Zero(), Vector::Zero(), Vector::Zero()};
};

struct Node {
  Point x;
  Vector lambda;
  double weight;
};

int placeNodes(const Simplex& s, Rule rule, std::array<Node, 16>& nodes) {
  int n = 0;
  for (const RulePoint& r : rule) {
    Node& node = nodes[n++];
    node.x.setZero();
    node.lambda.setZero();
    for (int k = 0; k < s.corners; ++k) {
      node.x += r.lambda[k] * s.point[k];
      node.lambda += r.lambda[k] * s.lambda[k];
    }
    node.weight = r.weight * s.share;
  }
  return n;
}

void addMean(const Simplex& a, const Simplex& b, const Ladder& ladder, int depth, Mean& mean) {
  const double ratio = (a.centre - b.centre).norm() / (a.radius + b.radius);
  if (ratio < ladder.sixteen && depth < ladder.depth) {
    const bool cutA = a.radius >= b.radius;
    for (const Simplex& part : halves(cutA ? a : b)) {
      if (cutA) {
        addMean(part, b, ladder, depth + 1, mean);
      } else {
        addMean(a, part, ladder, depth + 1, mean);
      }
    }
    return;
  }
  std::array<Node, 16> nodesA;
  std::array<Node, 16> nodesB;
  const int countA = placeNodes(a, ruleFor(a.corners, ratio, ladder), nodesA);
  const int countB = placeNodes(b, ruleFor(b.corners, ratio, ladder), nodesB);
  std::array<Vector, 16> onB;
  onB.fill(Vector::Zero());
  for (int i = 0; i < countA; ++i) {
    Vector onA = Vector::Zero();
    for (int j = 0; j < countB; ++j) {
      const Vector z = nodesA[i].x - nodesB[j].x;
      const double squared = z.squaredNorm();
      if (squared == 0) continue;  // only where faces touch and the subdivision has ended
      const double term = nodesA[i].weight * nodesB[j].weight / squared;
      mean.value += term;
      const Vector force = (-2 * term / squared) * z;
      onA += force;
      onB[j] -= force;
    }
    for (int k = 0; k < 3; ++k) mean.byA[k] += nodesA[i].lambda[k] * onA;
  }
  for (int j = 0; j < countB; ++j) {
    for (int k = 0; k < 3; ++k) mean.byB[k] += nodesB[j].lambda[k] * onB[j];
  }
}

Mean meanOver(const Simplex& a, const Simplex& b, PairAccuracy accuracy) {
  Mean mean;
  addMean(a, b, ladderFor(accuracy), 0, mean);
  return mean;
}

/// Multiplies a mean and its derivatives by both areas.
PairIntegral timesAreas(const PairIntegral& mean, const Corners& s, const Corners& t) {
  const AreaGradient areaS = areaGradient(s);
  const AreaGradient areaT = areaGradient(t);
  const double product = areaS.area * areaT.area;
  PairIntegral result;
  result.value = product * mean.value;
  for (int k = 0; k < 3; ++k) {
    result.byS[k] = product * mean.byS[k] + mean.value * areaT.area * areaS.byCorner[k];
    result.byT[k] = product * mean.byT[k] + mean.value * areaS.area * areaT.byCorner[k];
  }
  return result;
}

}  // namespace

PairIntegral integrateApart(const Corners& s, const Corners& t, PairAccuracy accuracy) {
  const Mean mean = meanOver(whole({s[0], s[1], s[2]}), whole({t[0], t[1], t[2]}), accuracy);
  return timesAreas({mean.value, mean.byA, mean.byB}, s, t);
}

PairIntegral integrateVertexSharing(const Corners& s, const Corners& t, PairAccuracy accuracy) {
  const Mean edgeS = meanOver(whole({s[1], s[2]}), whole({t[0], t[1], t[2]}), accuracy);
  const Mean edgeT = meanOver(whole({s[0], s[1], s[2]}), whole({t[1], t[2]}), accuracy);
  PairIntegral mean;
  mean.value = edgeS.value + edgeT.value;
  mean.byS = edgeT.byA;
  mean.byT = edgeS.byB;
  for (int k = 0; k < 2; ++k) {
    mean.byS[k + 1] += edgeS.byA[k];
    mean.byT[k + 1] += edgeT.byB[k];
  }
  return timesAreas(mean, s, t);
}

PairIntegral integrateEdgeSharing(const Corners& s, const Corners& t, PairAccuracy accuracy) {
  // Corners of the six triangles as multiples of e = q - p, a = s[2] - p, b = t[2] - p.
  struct Multiple {
    int e, a, b;
  };
  static constexpr Multiple kA = {0, 1, 0}, kE = {1, 0, 0}, kMinusB = {0, 0, -1},
                            kMinusE = {-1, 0, 0}, kEminusB = {1, 0, -1}, kAminusB = {0, 1, -1},
                            kAminusE = {-1, 1, 0};
  static constexpr std::array<std::array<Multiple, 3>, 6> kTriangles = {
      {{kA, kE, kEminusB},
       {kA, kEminusB, kAminusB},
       {kMinusB, kEminusB, kAminusB},
       {kMinusB, kMinusE, kAminusE},
       {kMinusB, kAminusE, kAminusB},
       {kA, kAminusE, kAminusB}}};
  const Vector e = s[1] - s[0];
  const Vector a = s[2] - s[0];
  const Vector b = t[2] - s[0];
  const Simplex origin = whole({Point::Zero()});
  const auto place = [&](const Multiple& m) { return Point(m.e * e + m.a * a + m.b * b); };

  PairIntegral mean;
  for (const auto& triangle : kTriangles) {
    const Mean part = meanOver(whole({place(triangle[0]), place(triangle[1]), place(triangle[2])}),
                               origin, accuracy);
    mean.value += part.value;
    for (int k = 0; k < 3; ++k) {
      const Multiple& m = triangle[k];
      mean.byS[0] -= (m.e + m.a + m.b) * part.byA[k];
      mean.byS[1] += m.e * part.byA[k];
      mean.byS[2] += m.a * part.byA[k];
      mean.byT[2] += m.b * part.byA[k];
    }
  }
  return timesAreas(mean, s, t);
}

}  // namespace explica::repulsion
