// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonMeasures.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

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

namespace {

/// The lines of a closed polygon's edges.
struct EdgeLines {
  explicit EdgeLines(const Curve& c)
      : curve(c), lengths(edgeLengths(c)), normals(c.edgeCount(), 2) {
    for (int e = 0; e < c.edgeCount(); ++e) {
      const Point2 t = (c.point(c.next(e)) - c.point(e)) / lengths[e];
      normals.row(e) << t.y(), -t.x();
    }
  }
  /// Distance of a vertex from an edge's line, outward positive.
  [[nodiscard]] double outward(int edge, int vertex) const {
    return normals.row(edge).dot(curve.positions.row(vertex) - curve.positions.row(edge));
  }

  const Curve& curve;
  Eigen::VectorXd lengths;
  Positions2 normals;
};

/// What edge i and the edges after it hide of each other, counted once.
double occlusionAfter(const EdgeLines& lines, int i) {
  const Curve& curve = lines.curve;
  const int i1 = curve.next(i);
  double sum = 0;
  double atEnd = 0;  // of edge i's line: the start of j is the end of the edge before
  for (int j = i + 1; j < curve.edgeCount(); ++j) {
    const int j1 = curve.next(j);
    // An end that lies on the other edge is on its line, whatever rounding says.
    const double yStart = j == i1 ? 0 : atEnd;
    atEnd = lines.outward(i, j1);
    const double yEnd = j1 == i ? 0 : atEnd;
    if (yStart <= 0 && yEnd <= 0) continue;
    const double xStart = i == j1 ? 0 : lines.outward(j, i);
    const double xEnd = i1 == j ? 0 : lines.outward(j, i1);
    if (xStart <= 0 && xEnd <= 0) continue;
    sum += lines.lengths[j] * positiveShare(xStart, xEnd) * positiveShare(yStart, yEnd);
  }
  return lines.lengths[i] * sum;
}

}  // namespace

double selfOcclusion(const Curve& curve) {
  requireClosed(curve);
  const EdgeLines lines(curve);
  std::vector<double> rows(static_cast<std::size_t>(curve.edgeCount()));
  parallelFor(rows.size(), 64,
              [&](std::size_t i) { rows[i] = occlusionAfter(lines, static_cast<int>(i)); });
  // The condition is the same for (i, j) and (j, i).
  return 2 * std::accumulate(rows.begin(), rows.end(), 0.0);
}

}  // namespace explica::planar
