// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/FaceFlux.h"

#include <Eigen/Geometry>

#include <cmath>

namespace explica::visibility {

FaceFlux faceFlux(const Point& a, const Point& b, const Point& c, const Point& viewpoint) {
  const std::array<Vector, 3> corner = {a - viewpoint, b - viewpoint, c - viewpoint};
  const Vector cross = (b - a).cross(c - a);
  const double twiceArea = cross.norm();
  if (twiceArea == 0) return faceFluxFar(a, b, c, viewpoint);
  const Vector n = cross / twiceArea;
  const double h = corner[0].dot(n);

  const std::array<double, 3> r = {corner[0].norm(), corner[1].norm(), corner[2].norm()};
  double potential = 0;            // integral of 1/r dS
  Vector moment = Vector::Zero();  // integral of rho/r dS
  std::array<Vector, 3> rim = {Vector::Zero(), Vector::Zero(), Vector::Zero()};  // of lambda dl x F
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const Vector& p = corner[k];
    const Vector& q = corner[next];
    const Vector edge = q - p;
    const double length = edge.norm();
    if (length == 0) continue;
    const Vector along = edge / length;
    const Vector outward = along.cross(n);
    const double lineDistance = p.dot(outward);
    const double lp = p.dot(along);
    const double lq = q.dot(along);
    // ln((r_q + l_q) / (r_p + l_p)) without cancellation; infinite only on the edge itself, where
    // its factors vanish.
    const double share = length / (r[k] + r[next]);
    const double logarithm = share < 1 ? 2 * std::atanh(share) : 0;
    potential += lineDistance * logarithm;
    const double squaredLineDistance = p.cross(along).squaredNorm();
    moment += outward * 0.5 * (squaredLineDistance * logarithm + lq * r[next] - lp * r[k]);
    const double first = r[next] - r[k];  // integral of l/r dl
    const Vector turn = along.cross(p);
    rim[k] += turn * ((lq * logarithm - first) / length);
    rim[next] += turn * ((first - lp * logarithm) / length);
  }
  // [VanOosterom1983]: tan(Omega / 2).
  const double determinant = corner[0].dot(corner[1].cross(corner[2]));
  const double denominator = r[0] * r[1] * r[2] + corner[0].dot(corner[1]) * r[2] +
                             corner[1].dot(corner[2]) * r[0] + corner[2].dot(corner[0]) * r[1];
  potential -= std::abs(h) * 2 * std::atan2(std::abs(determinant), denominator);

  FaceFlux result;
  result.flux = -h * potential;
  for (int k = 0; k < 3; ++k) {
    const Vector& p = corner[(k + 1) % 3];
    const Vector& q = corner[(k + 2) % 3];
    const Vector barycentricGradient = n.cross(q - p) / twiceArea;
    const double weighted =
        barycentricGradient.dot(moment) - barycentricGradient.dot(p) * potential;
    result.gradient[k] = -(2 * weighted * n + rim[k]);
  }
  return result;
}

FaceFlux faceFluxFar(const Point& a, const Point& b, const Point& c, const Point& viewpoint) {
  const std::array<Vector, 3> corner = {a - viewpoint, b - viewpoint, c - viewpoint};
  const Vector cross = (b - a).cross(c - a);
  Vector sum = Vector::Zero();  // of the unit rays
  FaceFlux result{.gradient = {Vector::Zero(), Vector::Zero(), Vector::Zero()}};
  for (int q = 0; q < 3; ++q) {
    const Vector x = (corner[0] + corner[1] + corner[2]) / 6 + corner[q] / 2;
    const double r = x.norm();
    if (r == 0) continue;
    const Vector ray = x / r;
    sum += ray;
    const Vector slope = (cross - ray * ray.dot(cross)) / r;  // of ray . cross
    for (int k = 0; k < 3; ++k) result.gradient[k] -= slope * ((k == q ? 4 : 1) / 36.0);
  }
  const Vector mean = sum / 6;  // mean ray, over 2 for the area
  result.flux = -mean.dot(cross);
  result.gradient[0] -= (b - c).cross(mean);
  result.gradient[1] -= (c - a).cross(mean);
  result.gradient[2] -= (a - b).cross(mean);
  return result;
}

}  // namespace explica::visibility
