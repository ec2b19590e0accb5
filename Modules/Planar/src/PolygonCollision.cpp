// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonCollision.h"

#include "Segment.h"

#include "Explica/Core/StopScope.h"

#include <algorithm>
#include <cmath>

namespace explica::planar {
namespace {

constexpr double kKeptShare = 0.5;      // of a pair's distance that a step must leave
constexpr int kMostAdvances = 100;      // conservative: what is reached by then is returned
constexpr double kLeastAdvance = 1e-4;  // of the step; less gains nothing

/// As largestSafeStep() for one pair, up to `limit`.
double safeTime(const std::array<Point2, 3>& x, std::array<Point2, 3> motion, double limit) {
  const Point2 mean = (motion[0] + motion[1] + motion[2]) / 3;
  for (Point2& m : motion) m -= mean;
  const double speed = motion[0].norm() + std::max(motion[1].norm(), motion[2].norm());
  const double start = distanceToSegment(x[0], x[1], x[2]);
  if (start == 0) return 0;
  const double kept = kKeptShare * start;
  if (speed * limit < start - kept) return limit;
  double t = 0;
  double distance = start;
  for (int k = 0; k < kMostAdvances; ++k) {
    const double advance = 0.99 * (distance - kept) / speed;
    if (t + advance >= limit) return limit;
    if (advance < kLeastAdvance * limit) break;
    t += advance;
    distance = distanceToSegment(x[0] + t * motion[0], x[1] + t * motion[1], x[2] + t * motion[2]);
  }
  return t;
}

}  // namespace

VertexEdgeDistance vertexEdgeDistance(const Curve& curve, int vertex, int edge) {
  const Point2 a = curve.point(edge);
  const Point2 b = curve.point(curve.next(edge));
  const Point2 q = curve.point(vertex);
  VertexEdgeDistance result{.parameter = nearestParameter(q, a, b)};
  const Point2 d = q - a - result.parameter * (b - a);
  result.distance = d.norm();
  if (result.distance > 0) result.direction = d / result.distance;
  return result;
}

std::vector<VertexEdgePair> nearbyPairs(const Curve& curve, const std::vector<bool>& moving,
                                        const Eigen::VectorXd& restLengths, double range,
                                        double reach) {
  std::vector<VertexEdgePair> pairs;
  if (curve.edgeCount() == 0) return pairs;
  // Vertices in their order along the curve's longer side: those beside an edge are found without
  // looking at the others.
  Eigen::Index axis = 0;
  (curve.positions.colwise().maxCoeff() - curve.positions.colwise().minCoeff()).maxCoeff(&axis);
  std::vector<std::pair<double, int>> along;
  for (int v = 0; v < curve.vertexCount(); ++v) along.emplace_back(curve.positions(v, axis), v);
  std::ranges::sort(along);
  std::vector<int> near;
  constexpr int kAtOnce = 1024;  // edges before a stop is heard
  for (int e = 0; e < curve.edgeCount(); ++e) {
    if (e % kAtOnce == 0) checkpoint();
    const int f = curve.next(e);
    const Point2 a = curve.point(e);
    const Point2 b = curve.point(f);
    const bool edgeMoves = moving[e] || moving[f];
    const Eigen::Array2d low = a.cwiseMin(b).array() - reach;
    const Eigen::Array2d high = a.cwiseMax(b).array() + reach;
    near.clear();
    for (auto at = std::ranges::lower_bound(along, std::pair(low[axis], 0));
         at != along.end() && at->first <= high[axis]; ++at) {
      const double across = curve.positions(at->second, 1 - axis);
      if (across >= low[1 - axis] && across <= high[1 - axis]) near.push_back(at->second);
    }
    std::ranges::sort(near);
    for (const int v : near) {
      if (v == e || v == f || !(edgeMoves || moving[v])) continue;
      if (distanceToSegment(curve.point(v), a, b) > reach) continue;
      double pairRange = range;
      if (v < curve.edgeCount() && curve.next(v) == e) {
        pairRange = std::min(pairRange, 0.5 * restLengths[v]);
      }
      if (f < curve.edgeCount() && curve.next(f) == v) {
        pairRange = std::min(pairRange, 0.5 * restLengths[f]);
      }
      pairs.push_back({v, e, pairRange});
    }
  }
  return pairs;
}

double largestSafeStep(const Curve& curve, const Positions2& target,
                       const std::vector<VertexEdgePair>& pairs) {
  double limit = 1;
  for (const VertexEdgePair& pair : pairs) {
    const std::array<int, 3> vertices = {pair.vertex, pair.edge, curve.next(pair.edge)};
    std::array<Point2, 3> x;
    std::array<Point2, 3> motion;
    for (int k = 0; k < 3; ++k) {
      x[k] = curve.point(vertices[k]);
      motion[k] = target.row(vertices[k]).transpose() - x[k];
    }
    limit = std::min(limit, safeTime(x, motion, limit));
    if (limit <= 0) return 0;
  }
  return limit;
}

BarrierValue barrier(double distance, double range) {
  if (distance >= range) return {};
  const double s = distance / range;
  const double log = std::log(s);
  const double below = s - 1;
  BarrierValue result;
  result.value = -below * below * log;
  result.slope = (-2 * below * log - below * below / s) / range;
  result.curvature = (-2 * log - 4 * below / s + below * below / (s * s)) / (range * range);
  return result;
}

double leastDistance(const Curve& curve, const std::vector<VertexEdgePair>& pairs) {
  double least = kInfinity;
  for (const VertexEdgePair& pair : pairs) {
    least = std::min(least, vertexEdgeDistance(curve, pair.vertex, pair.edge).distance);
  }
  return least;
}

}  // namespace explica::planar
