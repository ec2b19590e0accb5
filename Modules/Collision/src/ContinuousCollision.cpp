// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/ContinuousCollision.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace explica::collision {
namespace {

constexpr double kRoundUp = 1 + 1e-12;  // covers the few roundings in sums and norms below

/// Share of the provably free time that one advance uses, as in [Li2021].
constexpr double kAdvanceShare = 0.9;

/// Of the limit: below it further advances of a pair that closes do not matter.
constexpr double kSmallAdvance = 1e-6;

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
  // What moves as one keeps its distances, even where floating point cannot tell them from zero.
  if (motion[0] == motion[1] && motion[0] == motion[2] && motion[0] == motion[3]) return limit;
  const double speed = approachBound(kind, motion);
  const double start = distanceBound(kind, x);
  if (!(start > 0)) return 0;
  const double gap = options.keptShare * start;
  if (speed * limit <= start - gap) return limit;

  double time = 0, distance = start;
  for (int n = 0; n < options.maxAdvances; ++n) {
    const double next = time + kAdvanceShare * (distance - gap) / speed;
    if (next >= limit) return limit;
    if (next <= time) return time;  // no advance left that floating point can tell
    const bool small = next - time < kSmallAdvance * limit;
    FourPoints now = x;
    for (int i = 0; i < 4; ++i) now[i] += next * motion[i];
    time = next;
    const double before = std::exchange(distance, distanceBound(kind, now));
    // Pairs almost in contact that open start with small advances, which grow.
    if (distance <= gap || (small && distance <= before)) return time;
  }
  return time;
}

}  // namespace explica::collision
