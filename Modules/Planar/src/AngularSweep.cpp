// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/AngularSweep.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace explica::planar {
namespace {

double crossProduct(const Point2& a, const Point2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// An edge as seen from the viewpoint at the origin: from angle `begin` up to `end`.
struct Span {
  int edge;
  Point2 a;  ///< end at `begin`
  Point2 b;  ///< end at `end`
  double begin;
  double end;
  bool front;  ///< the outer side faces the viewpoint
  double length;

  /// Where along (a, b) the ray of a direction meets the edge, in [0, 1].
  [[nodiscard]] double parameter(const Point2& direction) const {
    return std::clamp(crossProduct(a, direction) / crossProduct(direction, b - a), 0.0, 1.0);
  }
  /// Distance along the ray of a unit direction.
  [[nodiscard]] double distance(const Point2& direction) const {
    return crossProduct(a, b - a) / crossProduct(direction, b - a);
  }
};

Point2 unit(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

/// What is seen of each edge of the curve, mm.
struct Seen {
  Eigen::VectorXd length;
  Eigen::VectorXd flux;  ///< that arrives
};

Seen seenOf(const Curve& curve, const Point2& viewpoint) {
  // Angles are taken from the direction of the curve's middle, where far viewpoints keep all
  // digits.
  const Point2 middle =
      (curve.positions.colwise().minCoeff() + curve.positions.colwise().maxCoeff()).transpose() / 2;
  const Point2 axis =
      middle == viewpoint ? Point2(1, 0) : Point2((middle - viewpoint).normalized());
  const auto seenFrom = [&](int vertex) {
    const Point2 d = curve.point(vertex) - viewpoint;
    return Point2(axis.dot(d), crossProduct(axis, d));
  };

  std::vector<Span> spans;
  const auto addSpan = [&](int edge, const Point2& a, const Point2& b, double begin, double end,
                           bool front, double length) {
    if (begin < end) spans.push_back({edge, a, b, begin, end, front, length});
  };
  for (int e = 0; e < curve.edgeCount(); ++e) {
    Point2 a = seenFrom(e);
    Point2 b = seenFrom(curve.next(e));
    if (a.isZero(0) || b.isZero(0)) throw InvalidInput("the viewpoint lies on the curve");
    // Clockwise about the viewpoint: it lies to the right of the edge, on its outer side.
    const bool front = crossProduct(a, b) < 0;
    if (front) std::swap(a, b);
    const double length = (b - a).norm();
    const double begin = std::atan2(a.y(), a.x());
    const double end = std::atan2(b.y(), b.x());
    if (begin <= end) {
      addSpan(e, a, b, begin, end, front, length);
    } else {  // across the cut at pi
      addSpan(e, a, b, begin, kPi, front, length);
      addSpan(e, a, b, -kPi, end, front, length);
    }
  }

  struct Event {
    double angle;
    int span;
    bool enters;
  };
  std::vector<Event> events;
  events.reserve(2 * spans.size());
  for (int s = 0; s < static_cast<int>(spans.size()); ++s) {
    events.push_back({spans[s].begin, s, true});
    events.push_back({spans[s].end, s, false});
  }
  std::ranges::stable_sort(events, {}, &Event::angle);

  Seen seen{Eigen::VectorXd::Zero(curve.edgeCount()), Eigen::VectorXd::Zero(curve.edgeCount())};
  std::vector<int> active;
  for (std::size_t k = 0; k < events.size(); ++k) {
    const Event& event = events[k];
    if (event.enters) {
      active.push_back(event.span);
    } else {
      active.erase(std::ranges::find(active, event.span));
    }
    if (k + 1 == events.size() || active.empty()) continue;
    const double begin = event.angle;
    const double end = events[k + 1].angle;
    if (!(begin < end)) continue;
    const Point2 ray = unit((begin + end) / 2);
    int nearest = -1;
    double nearestDistance = kInfinity;
    for (int s : active) {
      const double distance = spans[s].distance(ray);
      if (distance < nearestDistance) {
        nearestDistance = distance;
        nearest = s;
      }
    }
    if (nearest < 0 || !spans[nearest].front) continue;
    const Span& span = spans[nearest];
    const double from = span.parameter(unit(begin));
    const double to = span.parameter(unit(end));
    if (!(from < to)) continue;
    const Point2 way = span.b - span.a;
    seen.length[span.edge] += (to - from) * span.length;
    seen.flux[span.edge] += edgeFlux(span.a + to * way, span.a + from * way, Point2::Zero()).flux;
  }

  return seen;
}

}  // namespace

VisiblePart visiblePart(const Curve& curve, const Region& region, const Viewpoints& view) {
  if (region.edgeCount < 1) throw InvalidInput("visible part: the region has no edge");
  Eigen::VectorXd seen = Eigen::VectorXd::Zero(curve.edgeCount());
  Eigen::VectorXd flux = seen;
  for (std::size_t p = 0; p < view.points.size(); ++p) {
    const Seen one = seenOf(curve, view.points[p]);
    seen += view.weights[p] * one.length;
    flux += view.weights[p] * one.flux;
  }
  VisiblePart result;
  result.edgeSeen.resize(region.edgeCount);
  double seenLength = 0;
  double seenFlux = 0;
  double length = 0;
  for (int k = 0; k < region.edgeCount; ++k) {
    const int e = (region.firstEdge + k) % curve.edgeCount();
    const double edgeLength = (curve.positions.row(curve.next(e)) - curve.positions.row(e)).norm();
    result.edgeSeen[k] = std::min(1.0, seen[e] / edgeLength);
    seenLength += seen[e];
    seenFlux += flux[e];
    length += edgeLength;
  }
  result.fraction = std::min(1.0, seenLength / length);
  result.realVisibility = seenFlux / length;
  return result;
}

}  // namespace explica::planar
