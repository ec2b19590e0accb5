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
                                    const Viewpoints& view) {
  if (region.edgeCount < 1) throw InvalidInput("visibility: the region has no edge");
  if (view.points.empty() || view.points.size() != view.weights.size()) {
    throw InvalidInput("visibility: viewpoints with one weight each are needed");
  }
  const auto edges = static_cast<Eigen::Index>(region.edgeCount);
  PolygonVisibility result{.edgeFlux = Eigen::VectorXd::Zero(edges),
                           .gradient = Positions2::Zero(curve.vertexCount(), 2)};
  Positions2 lengthGradient = Positions2::Zero(curve.vertexCount(), 2);
  std::vector<double> flux(view.points.size());
  std::vector<double> squareFlux(view.points.size());
  for (int k = 0; k < region.edgeCount; ++k) {
    const int e = (region.firstEdge + k) % curve.edgeCount();
    const int f = curve.next(e);
    const Eigen::RowVector2d t = curve.positions.row(f) - curve.positions.row(e);
    const double length = t.norm();
    for (std::size_t p = 0; p < view.points.size(); ++p) {
      const double weight = view.weights[p];
      const EdgeFlux edge = edgeFlux(curve.point(e), curve.point(f), view.points[p]);
      flux[p] += edge.flux;
      squareFlux[p] += edge.squareFlux;
      result.edgeFlux[k] += weight * edge.flux / length;
      result.gradient.row(e) += weight * edge.byStart.transpose();
      result.gradient.row(f) += weight * edge.byEnd.transpose();
    }
    result.length += length;
    lengthGradient.row(e) -= t / length;
    lengthGradient.row(f) += t / length;
  }
  for (std::size_t p = 0; p < view.points.size(); ++p) {
    const double average = flux[p] / result.length;
    result.average += view.weights[p] * average;
    result.variance += view.weights[p] * (squareFlux[p] / result.length - average * average);
  }
  result.gradient = (result.gradient - result.average * lengthGradient) / result.length;
  return result;
}

}  // namespace explica::planar
