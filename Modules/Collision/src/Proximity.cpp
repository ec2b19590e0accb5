// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/Proximity.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::collision {
namespace {

using Weights = std::array<double, 4>;

Vector combine(const Weights& w, const FourPoints& x) {
  // Weights sum to zero, so differences to x[0] carry all and keep far-away pairs accurate.
  return w[1] * (x[1] - x[0]) + w[2] * (x[2] - x[0]) + w[3] * (x[3] - x[0]);
}

void keepNearer(Proximity& best, const FourPoints& x, const Weights& weights) {
  const Vector difference = combine(weights, x);
  const double squared = difference.squaredNorm();
  if (squared < best.squaredDistance) best = {weights, difference, squared};
}

/// Parameter in [0, 1] of the point of segment a + t (b - a) next to q; 0 for a degenerate segment.
double segmentParameter(const Point& q, const Point& a, const Point& b) {
  const Vector along = b - a;
  const double squaredLength = along.squaredNorm();
  if (!(squaredLength > 0)) return 0;
  return std::clamp(along.dot(q - a) / squaredLength, 0.0, 1.0);
}

Proximity vertexFace(const FourPoints& x) {
  Proximity best;
  // Cross products lose eps / sin(angle) where normal equations would lose eps / sin^2.
  const Vector ab = x[2] - x[1], ac = x[3] - x[1], aq = x[0] - x[1];
  const Vector normal = ab.cross(ac);
  const double squaredNormal = normal.squaredNorm();
  if (squaredNormal > 0) {
    const double u = aq.cross(ac).dot(normal) / squaredNormal;
    const double v = ab.cross(aq).dot(normal) / squaredNormal;
    if (u > 0 && v > 0 && u + v < 1) {
      keepNearer(best, x, {1, u + v - 1, -u, -v});
    }
  }
  for (int k = 0; k < 3; ++k) {
    const int a = 1 + k, b = 1 + (k + 1) % 3;
    const double t = segmentParameter(x[0], x[a], x[b]);
    Weights weights = {1, 0, 0, 0};
    weights[a] = t - 1;
    weights[b] = -t;
    keepNearer(best, x, weights);
  }
  return best;
}

Proximity edgeEdge(const FourPoints& x) {
  Proximity best;
  const Vector u = x[1] - x[0], v = x[3] - x[2], w = x[2] - x[0];
  const Vector normal = u.cross(v);
  const double squaredNormal = normal.squaredNorm();
  if (squaredNormal > 0) {
    const double s = w.cross(v).dot(normal) / squaredNormal;
    const double t = w.cross(u).dot(normal) / squaredNormal;
    if (s > 0 && s < 1 && t > 0 && t < 1) {
      keepNearer(best, x, {1 - s, s, t - 1, -t});
    }
  }
  for (int end = 0; end < 2; ++end) {
    const double t = segmentParameter(x[end], x[2], x[3]);
    Weights weights = {0, 0, t - 1, -t};
    weights[end] = 1;
    keepNearer(best, x, weights);
    const double s = segmentParameter(x[2 + end], x[0], x[1]);
    weights = {1 - s, s, 0, 0};
    weights[2 + end] = -1;
    keepNearer(best, x, weights);
  }
  return best;
}

}  // namespace

Proximity findProximity(PairKind kind, const FourPoints& x) {
  return kind == PairKind::VertexFace ? vertexFace(x) : edgeEdge(x);
}

double squaredDistance(PairKind kind, const FourPoints& x) {
  return findProximity(kind, x).squaredDistance;
}

Vector12 squaredDistanceGradient(const Proximity& proximity) {
  Vector12 gradient;
  for (int i = 0; i < 4; ++i) {
    gradient.segment<3>(3 * i) = 2 * proximity.weights[i] * proximity.difference;
  }
  return gradient;
}

double distanceBound(PairKind kind, const FourPoints& x) {
  constexpr double kSlide = 2e-8;   // of the spread: sqrt(eps) with a margin, see the header
  constexpr double kRound = 1e-14;  // of size and spread: some tens of roundings
  double spread = 0, size = 0;
  for (int i = 0; i < 4; ++i) {
    spread = std::max(spread, (x[i] - x[0]).lpNorm<Eigen::Infinity>());
    size = std::max(size, x[i].lpNorm<Eigen::Infinity>());
  }
  const double slide = kSlide * spread;
  const double squared = squaredDistance(kind, x) - slide * slide;
  return squared > 0 ? std::max(0.0, std::sqrt(squared) - kRound * (size + spread)) : 0;
}

}  // namespace explica::collision
