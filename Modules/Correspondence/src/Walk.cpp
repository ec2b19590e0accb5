// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Field.h"

#include <algorithm>
#include <cmath>

namespace explica::correspondence {

using harmonic::kInner;
using harmonic::kOuter;

namespace {

// A walk may not be longer than this many voxels per step taken on average: it circles.
constexpr double kTinyStep = 1e-6;
// A step ends beyond the boundary by about this share of its length plus this many voxels.
constexpr double kPastTarget = 1.1, kBeyondTarget = 0.02;
// A step longer than a voxel takes at most this share of the way that is left.
constexpr double kFarShare = 0.5;
// A step whose gain in u is below this share of |grad u| ds is inconsistent; the boundary is near
// within this many voxels; and a walk may have so many such steps.
constexpr double kEnough = 1e-5;  // voxels from the boundary at which a walk has arrived
constexpr double kPoorGain = 0.25;
constexpr double kNearEnd = 1.5;
constexpr int kStrikes = 8;
// Hops of a walk from voxel to voxel, and the least that u gains by one: less is round-off.
constexpr int kMostHops = 64;
constexpr double kLeastGain = 1e-7;

/// Where in (0, 1) the cubic with values and slopes f0 < 0, g0 and f1 > 0, g1 at 0 and 1 is zero,
/// by Newton steps from the chord's crossing; that crossing if they leave the interval.
double crossingOf(double f0, double g0, double f1, double g1) {
  const double chord = f0 / (f0 - f1);
  const double c = g0, d = 3 * (f1 - f0) - 2 * g0 - g1, e = 2 * (f0 - f1) + g0 + g1;
  double t = chord;
  for (int k = 0; k < 3; ++k) {
    t -= (f0 + t * (c + t * (d + t * e))) / (c + t * (2 * d + 3 * t * e));
    if (!(t > 0 && t < 1)) return chord;
  }
  return t;
}

Vector vectorOf(const Lanes& lanes, int lane) {
  return {lanes[0][lane], lanes[1][lane], lanes[2][lane]};
}

}  // namespace

Vector TrajectoryTracer::Field::velocityOf(const Sample& sample, int uphill, double* slope) const {
  // G per voxel is (per mm) * spacing; T = grad / |grad| in mm, then per voxel again.
  Vector perMm = sample.gradient.cwiseProduct(inverseSpacing);
  if (flat) perMm[2] = 0;
  const double norm = perMm.norm();
  if (slope != nullptr) *slope = norm;
  if (!(norm > view_.leastSlope)) return Vector::Zero();
  return (uphill / norm) * perMm.cwiseProduct(inverseSpacing);
}

TrajectoryTracer::Field::Walk TrajectoryTracer::Field::begin(const Vector& x, std::int32_t home,
                                                             int uphill) const {
  Walk walk;
  walk.x = x;
  const Sample here = sample(x, home);
  walk.home = here.home;
  walk.u = here.u;
  walk.velocity = velocityOf(here, uphill, &walk.slope);
  walk.divided = here.divided;
  walk.step = options.maxStep * finest;
  walk.stuck = here.home < 0 || walk.velocity.isZero(0);
  return walk;
}

TrajectoryTracer::Field::Walk TrajectoryTracer::Field::begin(std::int32_t place, int uphill) const {
  const std::int32_t row = place / annulus.size[0], slice = row / annulus.size[1];
  Walk walk;
  walk.x = Vector(place % annulus.size[0], row % annulus.size[1], slice);
  walk.home = annulus.numberAt[place];
  const Corner& here = node[rankAt[place]];
  walk.u = here[3];
  Sample sample;
  sample.gradient = here.head<3>().matrix().cast<double>();
  walk.velocity = velocityOf(sample, uphill, &walk.slope);
  walk.step = options.maxStep * finest;
  walk.stuck = walk.velocity.isZero(0);
  return walk;
}

bool TrajectoryTracer::Field::goStraight(Walk& walk, double target, int uphill) const {
  const double rest = uphill * (target - walk.u) / walk.slope;
  walk.stuck = !(rest < kNearEnd * finest);
  if (walk.stuck) return false;
  walk.x += rest * walk.velocity;
  walk.length += rest;
  walk.u = target;
  return true;
}

double TrajectoryTracer::Field::stepAfter(double step, double error) const {
  constexpr double kSafety = 0.9, kLeast = 0.3, kMost = 4.0;
  const double growth = std::min(kMost, options.maxStep * finest / step);
  // The cubic root only where the longest step is not within reach.
  if (error * growth * growth * growth <= kSafety * kSafety * kSafety * options.tolerance) {
    return growth * step;
  }
  return step * std::clamp(kSafety * std::cbrt(options.tolerance / error), kLeast, growth);
}

bool TrajectoryTracer::Field::hop(Walk& walk, double target, int uphill) const {
  walk.stuck = true;
  if (walk.home < 0 || ++walk.hops > kMostHops) return false;
  const auto s = annulus.boxSubscripts(walk.home);
  const Vector centre(s[0], s[1], s[2]);
  const std::int32_t wall = target > 0.5 ? kOuter : kInner;
  const auto& links = annulus.links[walk.home];
  const auto lengthTo = [&](const Vector& x) {
    return (x - walk.x).cwiseProduct(annulus.grid.spacing).norm();
  };
  Vector end = walk.x;
  double nearest = kInfinity;
  std::int32_t next = uphill * (interpolant.u[walk.home] - walk.u) > kLeastGain ? walk.home : -1;
  double steepest = 0;
  for (int d = 0; d < 6; ++d) {
    const int a = harmonic::axisOf(d);
    const Vector way = harmonic::signOf(d) * Vector::Unit(a);
    if (links[d] == wall) {
      const Vector x = centre + annulus.fractions[annulus.irregular(walk.home)][d] * way;
      if (lengthTo(x) < nearest) {
        nearest = lengthTo(x);
        end = x;
      }
    } else if (links[d] >= 0) {
      const double gain = uphill * (interpolant.u[links[d]] - walk.u);
      if (gain <= kLeastGain || gain <= steepest * annulus.grid.spacing[a]) continue;
      steepest = gain / annulus.grid.spacing[a];
      next = links[d];
    }
  }
  if (nearest < kInfinity) {
    walk.length += nearest;
    walk.x = end;
    walk.u = target;
    walk.stuck = false;
    return true;
  }
  if (next < 0) return false;
  Walk on = begin(annulus.place[next], uphill);
  on.length = walk.length + lengthTo(on.x);
  on.hops = walk.hops;
  walk = on;
  return false;
}

void TrajectoryTracer::Field::limitStep(Walk& walk, double target, int uphill) const {
  // Half a voxel at most where the side must be known: a step then never leaves its neighbourhood.
  const double rest = uphill * (target - walk.u) / walk.slope;
  const double longest = walk.divided ? 0.5 * finest : std::max(finest, kFarShare * rest);
  // Not far past the target either, where what is extended beyond the boundary bends.
  walk.step = std::min(
      {walk.step, longest, options.maxStep * finest, kPastTarget * rest + kBeyondTarget * finest});
}

void TrajectoryTracer::Field::attempt(const Walk* walks, StepLanes& tries, int count,
                                      int uphill) const {
  tries.count = count;
  tries.uphill = uphill;
  for (int w = 0; w < count; ++w) {
    for (int a = 0; a < 3; ++a) {
      tries.x[a][w] = walks[w].x[a];
      tries.velocity[a][w] = walks[w].velocity[a];
    }
    tries.step[w] = walks[w].step;
    tries.home[w] = walks[w].home;
  }
  tryStep(view_, tries);
}

std::int32_t TrajectoryTracer::Field::homeAtEnd(const StepLanes& tries, int lane) const {
  if (tries.endHome[lane] >= 0) return tries.endHome[lane];
  const auto strides = annulus.strides();
  const auto at = [&](int c) {
    return annulus
        .numberAt[tries.cell[lane] + (c & 1) + (c >> 1 & 1) * strides[1] + (c >> 2) * strides[2]];
  };
  std::int32_t home = at(tries.nearest[lane]);
  for (int c = 0; home < 0 && c < 8; ++c) home = at(c);
  return home;
}

TrajectoryTracer::Field::Outcome TrajectoryTracer::Field::conclude(Walk& walk,
                                                                   const StepLanes& tries, int lane,
                                                                   double target,
                                                                   int uphill) const {
  const double s = walk.step, error = tries.error[lane], u = tries.u[lane];
  const bool lost = tries.lost[lane] || !(tries.slope[lane] > view_.leastSlope);
  const auto straight = [&] {
    return goStraight(walk, target, uphill) ? Outcome::Arrived : Outcome::Advanced;
  };
  if (lost || error > options.tolerance) {
    // At the end of the cells that know the tissue: the boundary is there, or as near as the
    // extension beyond it is good.
    if (s < kTinyStep * finest) return straight();
    walk.step = lost ? 0.25 * s : s * std::max(0.2, 0.9 * std::cbrt(options.tolerance / error));
    return Outcome::Again;
  }
  if (uphill * (u - target) >= 0) {
    arrive(walk, tries, lane, target, uphill);
    return Outcome::Arrived;
  }
  // Where the tissue is thinner than the grid resolves, the extension beyond the boundary may
  // bend a trajectory along it.  Then u does not gain what its slope promises: if the boundary
  // is near, go straight to it.
  if (uphill * (u - walk.u) < kPoorGain * walk.slope * s) {
    if (goStraight(walk, target, uphill)) return Outcome::Arrived;
    walk.stuck = ++walk.strikes > kStrikes;
    if (walk.stuck) return Outcome::Advanced;
  }
  walk.x = vectorOf(tries.end, lane);
  walk.velocity = vectorOf(tries.k4, lane);
  walk.home = homeAtEnd(tries, lane);
  walk.divided = tries.divided[lane];
  walk.u = u;
  walk.slope = tries.slope[lane];
  walk.length += s;
  walk.step = stepAfter(s, error);
  return Outcome::Advanced;
}

void TrajectoryTracer::Field::arrive(Walk& walk, const StepLanes& tries, int lane, double target,
                                     int uphill) const {
  constexpr int kMostTries = 12;
  const double s = walk.step;
  const Vector end = vectorOf(tries.end, lane), k4 = vectorOf(tries.k4, lane);
  // On the step's cubic.
  const auto at = [&](double t) {
    const double t2 = t * t, t3 = t2 * t;
    return Vector((2 * t3 - 3 * t2 + 1) * walk.x + (t3 - 2 * t2 + t) * s * walk.velocity +
                  (-2 * t3 + 3 * t2) * end + (t3 - t2) * s * k4);
  };
  const auto along = [&](double t) {  // its derivative
    return Vector(6 * (t * t - t) * (walk.x - end) + (3 * t * t - 4 * t + 1) * s * walk.velocity +
                  (3 * t * t - 2 * t) * s * k4);
  };
  double low = 0, high = 1, t = 0;
  const double fLow = uphill * (walk.u - target), fHigh = uphill * (tries.u[lane] - target);
  if (fLow < 0) {
    // From where the cubic through both ends' u and slopes crosses, by Newton steps that stay
    // between places before and behind the target.
    t = crossingOf(fLow, s * walk.slope, fHigh, s * tries.slope[lane]);
    for (int k = 0; k < kMostTries; ++k) {
      const Sample here = sample(at(t), walk.home);
      const double value = uphill * (here.u - target);
      if (std::abs(value) < kEnough * walk.slope * finest) break;
      (value < 0 ? low : high) = t;
      t -= value / (uphill * here.gradient.dot(along(t)));
      if (!(t > low && t < high)) t = 0.5 * (low + high);
    }
  }
  walk.x = at(t);
  walk.u = target;
  walk.length += t * s;
}

bool TrajectoryTracer::Field::advance(Walk& walk, double target, int uphill) const {
  limitStep(walk, target, uphill);
  StepLanes tries;
  Outcome outcome = Outcome::Again;
  while (outcome == Outcome::Again) {
    attempt(&walk, tries, 1, uphill);
    outcome = conclude(walk, tries, 0, target, uphill);
  }
  return outcome == Outcome::Arrived || (walk.stuck && hop(walk, target, uphill));
}

Trace TrajectoryTracer::Field::run(Walk walk, double target, int uphill) const {
  Trace result;
  bool done = uphill * (walk.u - target) >= 0;
  for (int k = 0; !done && !walk.stuck && k < kMaxSteps; ++k) done = advance(walk, target, uphill);
  result.reached = done;
  result.point = toWorld(walk.x);
  result.length = walk.length;
  result.u = walk.u;
  return result;
}

}  // namespace explica::correspondence
