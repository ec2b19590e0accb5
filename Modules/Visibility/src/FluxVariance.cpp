// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/FluxVariance.h"

#include "Explica/Core/Errors.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace explica::visibility {
namespace {

constexpr double kNear = 8;       // distance over longest edge below which a face is divided
constexpr int kMostHalvings = 8;  // of a face's edges: a viewpoint on the surface ends here
constexpr std::size_t kVarianceGrain = 256;  // elements a task

struct Corners {
  Point a, b, c;
};

/// Integrals of 1 / r^2 and 1 / r over a triangle, r the distance from the origin.
struct Potentials {
  double square = 0;
  double plain = 0;
};

/// Radon's rule: the centroid, and three points on each of two circles about it.
Potentials bySevenPoints(const Corners& t) {
  static const double root = std::sqrt(15.0);
  static const std::array<double, 2> nearCorner = {(6 - root) / 21, (6 + root) / 21};
  static const std::array<double, 2> weight = {(155 - root) / 1200, (155 + root) / 1200};
  const double area = (t.b - t.a).cross(t.c - t.a).norm() / 2;
  Potentials sum;
  const auto add = [&](const Point& x, double w) {
    const double r2 = x.squaredNorm();
    sum.square += w * area / r2;
    sum.plain += w * area / std::sqrt(r2);
  };
  add((t.a + t.b + t.c) / 3, 9.0 / 40);
  for (int k = 0; k < 2; ++k) {
    const double s = nearCorner[k];
    const Point all = s * (t.a + t.b + t.c);
    for (const Point& corner : {t.a, t.b, t.c}) add(all + (1 - 3 * s) * corner, weight[k]);
  }
  return sum;
}

Potentials potentialsOf(const Corners& t, int halvings) {
  const double edge2 =
      std::max({(t.b - t.a).squaredNorm(), (t.c - t.b).squaredNorm(), (t.a - t.c).squaredNorm()});
  const bool near = ((t.a + t.b + t.c) / 3).squaredNorm() < kNear * kNear * edge2;
  if (!near || halvings == 0) return bySevenPoints(t);
  const Point ab = (t.a + t.b) / 2, bc = (t.b + t.c) / 2, ca = (t.c + t.a) / 2;
  Potentials sum;
  for (const Corners& part :
       {Corners{t.a, ab, ca}, Corners{ab, t.b, bc}, Corners{ca, bc, t.c}, Corners{ab, bc, ca}}) {
    const Potentials one = potentialsOf(part, halvings - 1);
    sum.square += one.square;
    sum.plain += one.plain;
  }
  return sum;
}

}  // namespace

double fluxVariance(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces,
                    const Viewpoints& viewpoints) {
  if (faces.empty()) throw InvalidInput("flux variance: there is no face");
  if (viewpoints.points.empty()) throw InvalidInput("flux variance: there is no viewpoint");
  double variance = 0;
  for (std::size_t p = 0; p < viewpoints.points.size(); ++p) {
    using Sums = Eigen::Array3d;  // area, flux, its square
    const Point& from = viewpoints.points[p];
    const Sums sums = parallelSum(
        faces.size(), kVarianceGrain, Sums(Sums::Zero()), [&](std::size_t begin, std::size_t end) {
          Sums part = Sums::Zero();
          for (std::size_t i = begin; i < end; ++i) {
            const Eigen::Index f = faces[i];
            const Corners t = {mesh.corner(f, 0) - from, mesh.corner(f, 1) - from,
                               mesh.corner(f, 2) - from};
            const Vector cross = (t.b - t.a).cross(t.c - t.a);
            const double area = cross.norm() / 2;
            if (!(area > 0)) continue;
            // The plane's distance: positive where the outer side looks at the viewpoint.
            const double height = -t.a.dot(cross) / (2 * area);
            const Potentials r = potentialsOf(t, kMostHalvings);
            part += Sums(area, height * r.plain, height * height * r.square);
          }
          return part;
        });
    if (!(sums[0] > 0)) throw InvalidInput("flux variance: the faces have no area");
    const double mean = sums[1] / sums[0];
    variance += viewpoints.weights[p] * std::max(0.0, sums[2] / sums[0] - mean * mean);
  }
  return variance;
}

}  // namespace explica::visibility
