// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/Curve.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/Predicates.h"
#include "Segment.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace explica::planar {
namespace {

/// True if r, known to be on the line of (p, q), lies between them.
bool between(const Point2& p, const Point2& q, const Point2& r) {
  return r.x() >= std::min(p.x(), q.x()) && r.x() <= std::max(p.x(), q.x()) &&
         r.y() >= std::min(p.y(), q.y()) && r.y() <= std::max(p.y(), q.y());
}

/// True if two edges that leave a common vertex run over each other.
bool foldedFlat(const Point2& common, const Point2& a, const Point2& b) {
  return geometry::orientation(common, a, b) == 0 && (a - common).dot(b - common) > 0;
}

bool edgesMeet(const Curve& curve, int i, int j) {
  const int i1 = curve.next(i);
  const int j1 = curve.next(j);
  if (i1 == j && j1 == i) return true;  // two edges over the same two vertices
  if (i1 == j) return foldedFlat(curve.point(j), curve.point(i), curve.point(j1));
  if (j1 == i) return foldedFlat(curve.point(i), curve.point(j), curve.point(i1));
  return segmentsMeet(curve.point(i), curve.point(i1), curve.point(j), curve.point(j1));
}

}  // namespace

bool segmentsMeet(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const int abc = geometry::orientation(a, b, c);
  const int abd = geometry::orientation(a, b, d);
  const int cda = geometry::orientation(c, d, a);
  const int cdb = geometry::orientation(c, d, b);
  if (abc * abd < 0 && cda * cdb < 0) return true;
  return (abc == 0 && between(a, b, c)) || (abd == 0 && between(a, b, d)) ||
         (cda == 0 && between(c, d, a)) || (cdb == 0 && between(c, d, b));
}

double distanceTo(const Curve& curve, const Point2& q) {
  double least = kInfinity;
  for (int e = 0; e < curve.edgeCount(); ++e) {
    least = std::min(least, distanceToSegment(q, curve.point(e), curve.point(curve.next(e))));
  }
  return least;
}

Region regionBetween(const Curve& curve, int first, int last) {
  const int n = curve.vertexCount();
  if (first < 0 || last < 0 || first >= n || last >= n) {
    throw InvalidInput("region " + std::to_string(first) + ":" + std::to_string(last) +
                       " leaves the vertices 0.." + std::to_string(n - 1) + " of the polygon");
  }
  if (first == last || (!curve.closed && last < first)) {
    throw InvalidInput("region " + std::to_string(first) + ":" + std::to_string(last) +
                       " holds no edge: give its first and last vertex in the polygon's order");
  }
  return {first, (last - first + n) % n};
}

Region wholeRegion(const Curve& curve) {
  return {0, curve.edgeCount()};
}

Region regionFacing(const Curve& curve, const Point2& viewpoint) {
  const Point2 ahead = curve.positions.colwise().mean().transpose() - viewpoint;
  Eigen::VectorXd angles(curve.vertexCount());  // counter-clockwise of the view ahead
  for (int v = 0; v < curve.vertexCount(); ++v) {
    const Point2 ray = curve.point(v) - viewpoint;
    angles[v] = std::atan2(ahead.x() * ray.y() - ahead.y() * ray.x(), ahead.dot(ray));
  }
  int first = 0, last = 0;
  if (!curve.closed || !(angles.maxCoeff(&first) - angles.minCoeff(&last) < kPi)) {
    throw InvalidInput("region: a viewpoint well outside a closed polygon is needed to find it");
  }
  return regionBetween(curve, first, last);
}

std::vector<int> edgesOf(const Curve& curve, const Region& region) {
  std::vector<int> edges(region.edgeCount);
  for (int k = 0; k < region.edgeCount; ++k) edges[k] = (region.firstEdge + k) % curve.edgeCount();
  return edges;
}

std::vector<int> verticesOf(const Curve& curve, const Region& region) {
  const int n = curve.vertexCount();
  std::vector<int> vertices(std::min(region.edgeCount + 1, n));
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    vertices[k] = (region.firstEdge + static_cast<int>(k)) % n;
  }
  return vertices;
}

Eigen::VectorXd edgeLengths(const Curve& curve) {
  Eigen::VectorXd lengths(curve.edgeCount());
  for (int e = 0; e < curve.edgeCount(); ++e) {
    lengths[e] = (curve.positions.row(curve.next(e)) - curve.positions.row(e)).norm();
  }
  return lengths;
}

double lengthOf(const Curve& curve, const Region& region) {
  double length = 0;
  for (int e : edgesOf(curve, region)) {
    length += (curve.positions.row(curve.next(e)) - curve.positions.row(e)).norm();
  }
  return length;
}

Point2 centroidOf(const Curve& curve, const Region& region) {
  Point2 sum = Point2::Zero();
  double length = 0;
  for (int e : edgesOf(curve, region)) {
    const Point2 a = curve.point(e);
    const Point2 b = curve.point(curve.next(e));
    sum += (b - a).norm() * (a + b) / 2;
    length += (b - a).norm();
  }
  return sum / length;
}

double signedArea(const Positions2& polygon) {
  const Eigen::Index n = polygon.rows();
  double twice = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::RowVector2d a = polygon.row(i) - polygon.row(0);
    const Eigen::RowVector2d b = polygon.row((i + 1) % n) - polygon.row(0);
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

std::vector<std::array<int, 2>> intersectingEdges(const Curve& curve) {
  constexpr std::size_t kMostCrossings = 10'000'000;
  struct Box {
    Point2 low, high;
    int edge;
  };
  std::vector<std::pair<double, int>> leftmost;  // coordinate and edge: what is sorted is small
  for (int e = 0; e < curve.edgeCount(); ++e) {
    leftmost.emplace_back(std::min(curve.point(e).x(), curve.point(curve.next(e)).x()), e);
  }
  std::ranges::sort(leftmost);
  std::vector<Box> boxes;
  boxes.reserve(leftmost.size());
  for (const auto& [x, e] : leftmost) {
    const Point2 a = curve.point(e), b = curve.point(curve.next(e));
    boxes.push_back({a.cwiseMin(b), a.cwiseMax(b), e});
  }
  std::vector<std::array<int, 2>> pairs;
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    const Box& one = boxes[k];
    for (std::size_t m = k + 1; m < boxes.size() && boxes[m].low.x() <= one.high.x(); ++m) {
      const Box& other = boxes[m];
      if (other.low.y() > one.high.y() || other.high.y() < one.low.y()) continue;
      if (!edgesMeet(curve, one.edge, other.edge)) continue;
      pairs.push_back({std::min(one.edge, other.edge), std::max(one.edge, other.edge)});
      if (pairs.size() > kMostCrossings) {
        throw InvalidInput(
            "polygon: more than " + std::to_string(kMostCrossings) +
            " pairs of its edges cross; are its vertices in the order of an outline?");
      }
    }
  }
  std::ranges::sort(pairs);
  return pairs;
}

void requireUsable(const Curve& curve) {
  const int least = curve.closed ? 3 : 2;
  if (curve.vertexCount() < least) {
    throw InvalidInput("polygon: " + std::to_string(curve.vertexCount()) +
                       " vertices found, at least " + std::to_string(least) + " needed");
  }
  for (int v = 0; v < curve.vertexCount(); ++v) {
    if (!curve.positions.row(v).allFinite()) {
      throw InvalidInput("polygon: vertex " + std::to_string(v) + " is not finite");
    }
  }
  for (int e = 0; e < curve.edgeCount(); ++e) {
    if (curve.positions.row(e) == curve.positions.row(curve.next(e))) {
      throw InvalidInput("polygon: vertices " + std::to_string(e) + " and " +
                         std::to_string(curve.next(e)) + " are equal; remove one of them");
    }
  }
}

}  // namespace explica::planar
