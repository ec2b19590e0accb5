// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/PolygonVisibility.h"

#include "Explica/Core/Errors.h"

#include <cmath>

namespace explica::planar {

EdgeFlux edgeFlux(const Point2& a, const Point2& b, const Point2& viewpoint) {
  const Point2 p = a - viewpoint;
  const Point2 q = b - viewpoint;
  const Point2 t = b - a;
  const double length = t.norm();
  const double r0 = p.norm();
  const double r1 = q.norm();
  const double sum = r0 + r1;
  const double gamma = t.x() * p.y() - t.y() * p.x();  // [Thesis, Eq. 4.12]
  const double h = gamma / length;
  // sum^2 - length^2 = 2 (r0 r1 + p . q): no cancellation where the edge is far.
  const double gap = 2 * (r0 * r1 + p.dot(q));
  EdgeFlux result;
  // On the edge itself the flux is zero: h vanishes faster than the logarithm grows.
  if (gap <= 0) return result;
  const double potential = std::log1p(2 * length * (sum + length) / gap);
  result.flux = h * potential;
  result.squareFlux = std::abs(h) * std::abs(std::atan2(gamma, p.dot(q)));

  // d potential = 2 (sum dLength - length dSum) / gap.
  const Point2 tangent = t / length;
  const Point2 lengthByStart = -tangent;
  const Point2 potentialByStart = 2 / gap * (sum * lengthByStart - length * (p / r0));
  const Point2 potentialByEnd = 2 / gap * (sum * tangent - length * (q / r1));
  const Point2 gammaByStart(-q.y(), q.x());
  const Point2 gammaByEnd(p.y(), -p.x());
  result.byStart = potential * (gammaByStart - h * lengthByStart) / length + h * potentialByStart;
  result.byEnd = potential * (gammaByEnd - h * tangent) / length + h * potentialByEnd;
  return result;
}

PolygonVisibility polygonVisibility(const Curve& curve, const Region& region,
                                    const Point2& viewpoint) {
  if (region.edgeCount < 1) throw InvalidInput("visibility: the region has no edge");
  PolygonVisibility result;
  result.edgeFlux.resize(region.edgeCount);
  result.gradient = Positions2::Zero(curve.vertexCount(), 2);
  Positions2 lengthGradient = Positions2::Zero(curve.vertexCount(), 2);
  double flux = 0;
  double squareFlux = 0;
  for (int k = 0; k < region.edgeCount; ++k) {
    const int e = (region.firstEdge + k) % curve.edgeCount();
    const int f = curve.next(e);
    const EdgeFlux edge = edgeFlux(curve.point(e), curve.point(f), viewpoint);
    const Eigen::RowVector2d t = curve.positions.row(f) - curve.positions.row(e);
    const double length = t.norm();
    result.edgeFlux[k] = edge.flux / length;
    flux += edge.flux;
    squareFlux += edge.squareFlux;
    result.length += length;
    result.gradient.row(e) += edge.byStart.transpose();
    result.gradient.row(f) += edge.byEnd.transpose();
    lengthGradient.row(e) -= t / length;
    lengthGradient.row(f) += t / length;
  }
  result.average = flux / result.length;
  result.variance = squareFlux / result.length - result.average * result.average;
  result.gradient = (result.gradient - result.average * lengthGradient) / result.length;
  return result;
}

}  // namespace explica::planar
