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

/// Vertices in square cells, so that those in a box are found without looking at the others.
class VertexCells {
 public:
  /// @param width  of a cell, mm; larger ones are taken where there would be more than 4 a vertex
  VertexCells(const Positions2& positions, double width)
      : low_(positions.colwise().minCoeff()), width_(width) {
    const Eigen::Array2d extent = (positions.colwise().maxCoeff() - low_).transpose();
    const double most = 4.0 * static_cast<double>(positions.rows()) + 64;
    const auto cells = [&] { return ((extent / width_).floor() + 1).prod(); };
    while (!(cells() <= most)) width_ *= 2;
    columns_ = static_cast<int>(extent[0] / width_) + 1;
    rows_ = static_cast<int>(extent[1] / width_) + 1;
    begin_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
    for (Eigen::Index v = 0; v < positions.rows(); ++v) ++begin_[cellOf(positions.row(v)) + 1];
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    vertices_.resize(static_cast<std::size_t>(positions.rows()));
    std::vector<int> at = begin_;
    for (Eigen::Index v = 0; v < positions.rows(); ++v) {
      vertices_[at[cellOf(positions.row(v))]++] = static_cast<int>(v);
    }
  }

  /// Puts the vertices of all cells that the box touches, in rising order.
  void around(const Eigen::Array2d& low, const Eigen::Array2d& high,
              std::vector<int>& found) const {
    found.clear();
    const int firstColumn = along(low[0], 0, columns_), lastColumn = along(high[0], 0, columns_);
    const int firstRow = along(low[1], 1, rows_), lastRow = along(high[1], 1, rows_);
    for (int row = firstRow; row <= lastRow; ++row) {
      const std::size_t first = static_cast<std::size_t>(row) * columns_;
      found.insert(found.end(), vertices_.begin() + begin_[first + firstColumn],
                   vertices_.begin() + begin_[first + lastColumn + 1]);
    }
    std::ranges::sort(found);
  }

 private:
  [[nodiscard]] int along(double coordinate, int axis, int count) const {
    return static_cast<int>(std::clamp((coordinate - low_[axis]) / width_, 0.0, count - 1.0));
  }
  [[nodiscard]] std::size_t cellOf(const Eigen::RowVector2d& point) const {
    return static_cast<std::size_t>(along(point[1], 1, rows_)) * columns_ +
           along(point[0], 0, columns_);
  }

  Eigen::RowVector2d low_;
  double width_;
  int columns_ = 0, rows_ = 0;
  std::vector<int> begin_;     ///< of each cell's vertices, row by row
  std::vector<int> vertices_;  ///< cell by cell
};

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
  const double meanEdge = edgeLengths(curve).mean();
  const VertexCells cells(curve.positions, std::max(reach, meanEdge));
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
    cells.around(low, high, near);
    for (const int v : near) {
      if (v == e || v == f || !(edgeMoves || moving[v])) continue;
      const double x = curve.positions(v, 0);
      const double y = curve.positions(v, 1);
      if (x < low[0] || x > high[0] || y < low[1] || y > high[1]) continue;
      if (distanceToSegment({x, y}, a, b) > reach) continue;
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
