// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/ContinuousCollision.h"

#include <algorithm>
#include <cmath>

namespace explica::collision {
namespace {

constexpr double kRoundUp = 1 + 1e-12;  // covers the few roundings in sums and norms below

/// Share of the provably free time that one advance uses, as in [Li2021].
constexpr double kAdvanceShare = 0.9;

}  // namespace

double approachBound(PairKind kind, const FourPoints& motion) {
  // A common translation approaches nothing; without it the bound is tighter.
  const Vector mean = 0.25 * (motion[0] + motion[1] + motion[2] + motion[3]);
  std::array<double, 4> speed;
  for (int i = 0; i < 4; ++i) speed[i] = (motion[i] - mean).norm();
  const double bound = kind == PairKind::VertexFace
                           ? speed[0] + std::max({speed[1], speed[2], speed[3]})
                           : std::max(speed[0], speed[1]) + std::max(speed[2], speed[3]);
  double size = 0;
  for (int i = 0; i < 4; ++i) size = std::max(size, motion[i].lpNorm<Eigen::Infinity>());
  return kRoundUp * bound + 1e-15 * size;
}

double safeTime(PairKind kind, const FourPoints& x, const FourPoints& motion, double limit,
                const AdvanceOptions& options) {
  const double speed = approachBound(kind, motion);
  const double start = distanceBound(kind, x);
  if (!(start > 0)) return 0;
  const double gap = options.keptShare * start;
  if (speed * limit <= start - gap) return limit;

  double time = 0, distance = start;
  for (int n = 0; n < options.maxAdvances; ++n) {
    const double next = time + kAdvanceShare * (distance - gap) / speed;
    if (next >= limit) return limit;
    // No advance left that floating point can tell, or too small to matter.
    if (next <= time || next - time < 1e-6 * limit) return time;
    FourPoints now = x;
    for (int i = 0; i < 4; ++i) now[i] += next * motion[i];
    time = next;
    distance = distanceBound(kind, now);
    if (distance <= gap) return time;
  }
  return time;
}

}  // namespace explica::collision
