// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Star.h"

#include "Explica/Flattening/StarRelaxation.h"
#include "Explica/Geometry/SphereLocator.h"

#include <cmath>

namespace explica::sphere {
namespace {

/// The directions from which the whole ring is seen, within some 80 degrees of the first neighbour:
/// a convex cone.
std::vector<Vector> kernelOf(const Ring& ring) {
  constexpr double kWide = 4;  // tangent of half the width
  const TangentFrame frame = tangentFrame(ring.front());
  std::vector<Vector> cone;
  for (const auto& [a, b] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}) {
    cone.push_back(ring.front() + kWide * (a * frame.col(0) + b * frame.col(1)));
  }
  for (std::size_t n = 0; n < ring.size() && !cone.empty(); ++n) {
    const Vector normal = ring[n].cross(ring[(n + 1) % ring.size()] - ring[n]);
    cone = flattening::clipped(cone, [&](const Vector& v) { return normal.dot(v); });
  }
  return cone;
}

/// Centroid of a cone's section across its middle.
Vector middleOf(std::vector<Vector> cone) {
  Vector axis = Vector::Zero();
  for (const Vector& v : cone) axis += v.normalized();
  axis.normalize();
  Vector mean = Vector::Zero();
  for (Vector& v : cone) {
    v /= v.dot(axis);
    mean += v / static_cast<double>(cone.size());
  }
  double area = 0;
  Vector sum = Vector::Zero();
  for (std::size_t n = 0; n < cone.size(); ++n) {
    const Vector p = cone[n] - mean, q = cone[(n + 1) % cone.size()] - mean;
    const double a = axis.dot(p.cross(q));
    area += a;
    sum += a * (p + q);
  }
  return area > 0 ? Vector(mean + sum / (3 * area)) : mean;
}

/// Beside the first neighbour.
std::optional<Point> besideNeighbour(const Ring& ring) {
  const Point& from = ring.front();
  return flattening::placeBeside(
      ring, 0, [&](const Point& p) { return Vector(p - from.dot(p) * from); },
      [&](const Vector& a, const Vector& b) { return std::atan2(from.dot(a.cross(b)), a.dot(b)); },
      [&](const Vector& first, double angle, double share) {
        const Vector way = std::cos(angle) * first + std::sin(angle) * from.cross(first);
        return Point((from + share * way).normalized());
      },
      [&](const Point& p) { return seesRing(ring, p); });
}

flattening::StarTerms evaluate(const std::vector<RestFace>& rest, const Ring& ring,
                               const MapWeights& weights, const Point& place,
                               const TangentFrame& frame) {
  flattening::StarTerms terms;
  for (std::size_t n = 0; n < ring.size(); ++n) {
    const SphereFace face = sphereFace(rest[n], {place, ring[n], ring[(n + 1) % ring.size()]});
    const SphereDensity psi = sphereDensity(face.squaredJacobian, face.areaRatio, weights);
    const double w = rest[n].area;
    terms.value += w * psi.value;
    if (!std::isfinite(terms.value)) return terms;
    const Eigen::Vector2d s = frame.transpose() * face.gradientS[0];
    const Eigen::Vector2d d = frame.transpose() * face.gradientD[0];
    terms.gradient += w * (psi.dS * s + psi.dD * d);
    terms.hessian += w * ((2 * psi.dS + std::abs(psi.dD) / 2) * std::norm(rest[n].gradient[0]) *
                              Eigen::Matrix2d::Identity() +
                          psi.dSD * (s * d.transpose() + d * s.transpose()) +
                          convexDD(psi, face.squaredJacobian) * d * d.transpose());
  }
  return terms;
}

}  // namespace

bool seesRing(const Ring& ring, const Point& place) {
  for (std::size_t n = 0; n < ring.size(); ++n) {
    if (geometry::sphericalOrientation(place, ring[n], ring[(n + 1) % ring.size()]) <= 0)
      return false;
  }
  return true;
}

std::optional<Point> placeInside(const Ring& ring) {
  const std::vector<Vector> kernel = kernelOf(ring);
  if (kernel.size() >= 3) {
    const Point middle = middleOf(kernel).normalized();
    if (middle.allFinite() && seesRing(ring, middle)) return middle;
  }
  return besideNeighbour(ring);
}

Point relaxedPlace(const std::vector<RestFace>& rest, const Ring& ring, const MapWeights& weights,
                   const Point& place) {
  return flattening::relaxedBySteps(
      place,
      [&](const Point& at, bool) { return evaluate(rest, ring, weights, at, tangentFrame(at)); },
      [](const Point& from, const Eigen::Vector2d& step, double share) -> Point {
        return (from + share * tangentFrame(from) * step).normalized();
      });
}

bool insert(const flattening::Removal& removal, double scale, const MapWeights& weights,
            Positions& sphere) {
  constexpr double kLeastHeight = 1e-3;  // of the opposite edge
  Ring ring;
  for (const std::int32_t v : removal.ring) ring.push_back(sphere.row(v).transpose());
  const auto place = placeInside(ring);
  if (!place) return false;
  std::vector<RestFace> rest;
  for (std::size_t n = 0; n < ring.size(); ++n) {
    const double outer = scale * removal.outer[n];
    rest.push_back(flattening::restFace(
        {scale * removal.spokes[n], outer, scale * removal.spokes[(n + 1) % ring.size()]},
        kLeastHeight * outer));
  }
  const Point relaxed = relaxedPlace(rest, ring, weights, *place);
  sphere.row(removal.vertex) = (seesRing(ring, relaxed) ? relaxed : *place).transpose();
  return true;
}

}  // namespace explica::sphere
