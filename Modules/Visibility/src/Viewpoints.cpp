// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/Viewpoints.h"

#include "Explica/Core/Errors.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace explica::visibility {

Viewpoints viewpoint(const Point& point) {
  if (!point.allFinite()) throw InvalidInput("viewpoint: not finite");
  return {{point}, {1.0}};
}

Viewpoints viewpoints(const std::vector<Point>& points, const std::vector<double>& weights) {
  if (points.empty()) throw InvalidInput("viewpoints: there is none");
  for (const Point& point : points) {
    if (!point.allFinite()) throw InvalidInput("viewpoints: one is not finite");
  }
  Viewpoints result{points, weights};
  if (weights.empty()) result.weights.assign(points.size(), 1.0);
  double sum = 0;
  bool positive = result.weights.size() == points.size();
  for (const double w : result.weights) {
    positive = positive && w > 0;
    sum += w;
  }
  if (!positive || !(sum < kInfinity)) {
    throw InvalidInput("weights: one positive number a viewpoint is needed; there are " +
                       std::to_string(points.size()) + " viewpoints and " +
                       std::to_string(weights.size()) + " weights");
  }
  for (double& w : result.weights) w /= sum;
  return result;
}

namespace {

struct GaussPoint {
  double node;  ///< in (-1, 1)
  double weight;
};

/// The k-th largest node of Gauss's rule of n points, k = 1..n: Newton's method on the Legendre
/// polynomial, from Tricomi's estimate, which is nearer to it than to any other.
GaussPoint gaussLegendre(int n, int k) {
  constexpr int kNewtonSteps = 6;  // 4 reach the last digit for up to 64 points
  double x = std::cos(std::numbers::pi * (k - 0.25) / (n + 0.5)), slope = 1;
  for (int step = 0; step < kNewtonSteps; ++step) {
    double before = 1, p = x;
    for (int j = 2; j <= n; ++j) {
      before = std::exchange(p, ((2 * j - 1) * x * p - (j - 1) * before) / j);
    }
    slope = n * (x * p - before) / (x * x - 1);
    x -= p / slope;
  }
  return {x, 2 / ((1 - x * x) * slope * slope)};
}

}  // namespace

Viewpoints viewLine(const Point& start, const Point& end, int count) {
  if (count < 1 || count > 64) {
    throw InvalidInput("view line: " + std::to_string(count) +
                       " points; between 1 and 64 are possible");
  }
  if (!start.allFinite() || !end.allFinite()) throw InvalidInput("view line: an end is not finite");
  Viewpoints result;
  for (int k = count; k > 0; --k) {
    const auto [node, weight] = gaussLegendre(count, k);
    const double s = (1 + node) / 2;
    result.points.push_back((1 - s) * start + s * end);
    result.weights.push_back(weight / 2);
  }
  return result;
}

Viewpoints viewSurface(const TriangleMesh& surface) {
  Viewpoints result;
  double total = 0;
  for (Eigen::Index f = 0; f < surface.faceCount(); ++f) {
    const Point a = surface.corner(f, 0);
    const Point b = surface.corner(f, 1);
    const Point c = surface.corner(f, 2);
    const double area = (b - a).cross(c - a).norm() / 2;
    if (area == 0) continue;
    total += area;
    for (int k = 0; k < 3; ++k) {
      result.points.push_back((a + b + c) / 6 + surface.corner(f, k) / 2);
      result.weights.push_back(area / 3);
    }
  }
  if (!(total > 0) || !std::isfinite(total)) {
    throw InvalidInput("view surface: it has no face of finite positive area");
  }
  for (double& w : result.weights) w /= total;
  return result;
}

double windingNumber(const TriangleMesh& surface, const Point& point) {
  const double sum = parallelSum(
      static_cast<std::size_t>(surface.faceCount()), 4096, 0.0,
      [&](std::size_t begin, std::size_t end) {
        double angle = 0;
        for (auto f = static_cast<Eigen::Index>(begin); f < static_cast<Eigen::Index>(end); ++f) {
          const Vector a = surface.corner(f, 0) - point;
          const Vector b = surface.corner(f, 1) - point;
          const Vector c = surface.corner(f, 2) - point;
          const double la = a.norm();
          const double lb = b.norm();
          const double lc = c.norm();
          angle += 2 * std::atan2(a.dot(b.cross(c)),
                                  la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
        }
        return angle;
      });
  return sum / (4 * kPi);
}

}  // namespace explica::visibility
