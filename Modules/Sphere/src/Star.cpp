// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Star.h"

#include "Explica/Geometry/SphereLocator.h"

#include <Eigen/LU>

#include <cmath>

namespace explica::sphere {
namespace {

/// The part of a convex cone, given by its edges in order, in front of a plane through the origin.
std::vector<Vector> clipped(const std::vector<Vector>& cone, const Vector& normal) {
  std::vector<Vector> kept;
  for (std::size_t n = 0; n < cone.size(); ++n) {
    const Vector &p = cone[n], &q = cone[(n + 1) % cone.size()];
    const double sp = normal.dot(p), sq = normal.dot(q);
    if (sp >= 0) kept.push_back(p);
    if ((sp > 0 && sq < 0) || (sp < 0 && sq > 0)) kept.push_back(p + sp / (sp - sq) * (q - p));
  }
  return kept;
}

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
    const Vector& next = ring[(n + 1) % ring.size()];
    cone = clipped(cone, ring[n].cross(next - ring[n]));
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

/// Beside the first neighbour, along the bisector of the angle that the ring has there.  The faces
/// that join it to the ring are positive, so near enough the ring is seen, though the angle may be
/// of more than 180 degrees.
std::optional<Point> placeBeside(const Ring& ring) {
  const Point& from = ring.front();
  const auto along = [&](const Point& p) -> Vector { return p - from.dot(p) * from; };
  double angle = 0;
  for (std::size_t n = 1; n + 1 < ring.size(); ++n) {
    const Vector a = along(ring[n]), b = along(ring[n + 1]);
    angle += std::atan2(from.dot(a.cross(b)), a.dot(b));
  }
  const Vector first = along(ring[1]);
  const Vector way = std::cos(angle / 2) * first + std::sin(angle / 2) * from.cross(first);
  double share = 0.5;
  for (int n = 0; n < flattening::kHalvings; ++n, share /= 2) {
    const Point tried = (from + share * way).normalized();
    if (seesRing(ring, tried)) return tried;
  }
  return {};
}

struct StarTerms {
  double value = 0;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
};

StarTerms evaluate(const std::vector<RestFace>& rest, const Ring& ring, const MapWeights& weights,
                   const Point& place, const TangentFrame& frame) {
  StarTerms terms;
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
  return placeBeside(ring);
}

Point relaxedPlace(const std::vector<RestFace>& rest, const Ring& ring, const MapWeights& weights,
                   Point place, int maxSteps) {
  for (int n = 0; n < maxSteps; ++n) {
    const TangentFrame frame = tangentFrame(place);
    const StarTerms terms = evaluate(rest, ring, weights, place, frame);
    if (!std::isfinite(terms.value)) break;
    const Eigen::Vector2d step = -(terms.hessian.inverse() * terms.gradient);
    if (!(-terms.gradient.dot(step) > flattening::kEnoughOfStar * terms.value)) break;
    double share = 1;
    bool moved = false;
    for (int halving = 0; halving < 20 && !moved; ++halving, share /= 2) {
      const Point tried = (place + share * frame * step).normalized();
      if (!(evaluate(rest, ring, weights, tried, frame).value < terms.value)) continue;
      place = tried;
      moved = true;
    }
    if (!moved) break;
  }
  return place;
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
