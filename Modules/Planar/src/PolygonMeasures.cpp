// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonMeasures.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>

namespace explica::planar {
namespace {

/// Share of an edge on which a linear function with these end values is positive.
double positiveShare(double atStart, double atEnd) {
  if (atStart <= 0 && atEnd <= 0) return 0;
  if (atStart >= 0 && atEnd >= 0) return 1;
  return std::max(atStart, atEnd) / std::abs(atEnd - atStart);
}

void requireClosed(const Curve& curve) {
  if (!curve.closed) throw InvalidInput("global measures need a closed polygon");
}

}  // namespace

double hiddenViewingArc(const Curve& curve, const Point2& centre, double radius) {
  requireClosed(curve);
  double energy = 0;
  for (int i = 0; i < curve.edgeCount(); ++i) {
    const Point2 a = curve.point(i) - centre;
    const Point2 t = curve.point(curve.next(i)) - centre - a;
    if (a.norm() >= radius) {
      throw InvalidInput("hidden arc: vertex " + std::to_string(i) +
                         " lies on or outside the viewing circle; take a larger radius");
    }
    const double length = t.norm();
    const double h = (t.y() * a.x() - t.x() * a.y()) / length;
    energy += radius * length * (2 * kPi - 2 * std::acos(h / radius));
  }
  return energy;
}

double selfOcclusion(const Curve& curve) {
  requireClosed(curve);
  const auto outward = [&](int edge, int vertex) {  // distance of a vertex from an edge's line
    const Point2 t = curve.point(curve.next(edge)) - curve.point(edge);
    const Point2 d = curve.point(vertex) - curve.point(edge);
    return (t.y() * d.x() - t.x() * d.y()) / t.norm();
  };
  const Eigen::VectorXd lengths = edgeLengths(curve);
  double energy = 0;
  for (int i = 0; i < curve.edgeCount(); ++i) {
    for (int j = 0; j < curve.edgeCount(); ++j) {
      if (i == j) continue;
      const int i1 = curve.next(i);
      const int j1 = curve.next(j);
      // An end that lies on the other edge is on its line, whatever rounding says.
      const double yStart = j == i1 ? 0 : outward(i, j);
      const double yEnd = j1 == i ? 0 : outward(i, j1);
      const double xStart = i == j1 ? 0 : outward(j, i);
      const double xEnd = i1 == j ? 0 : outward(j, i1);
      energy += lengths[i] * positiveShare(xStart, xEnd) * lengths[j] * positiveShare(yStart, yEnd);
    }
  }
  return energy;
}

}  // namespace explica::planar
