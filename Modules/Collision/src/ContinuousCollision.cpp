// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Collision/ContinuousCollision.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace explica::collision {
namespace {

constexpr double kRoundUp = 1 + 1e-12;  // covers the few roundings in sums and norms below

/// Share of the provably free time that one advance uses, as in [Li2021].
constexpr double kAdvanceShare = 0.9;

/// Of a pair; what is reached by then is returned.
constexpr int kMostAdvances = 200;

/// Of the limit: below it further advances of a pair that closes do not matter.
constexpr double kSmallAdvance = 1e-6;

/// Of a pair along the line that joins its nearest points: planes across that line keep the two
/// features apart, and move with the fastest of their points.
struct AlongLine {
  double separation = 0;  ///< mm, that the distance is not below
  double closing = 0;     ///< mm per unit time by which it falls at most, until any later time
};

AlongLine alongLine(PairKind kind, const FourPoints& x, const FourPoints& motion) {
  const Vector line = findProximity(kind, x).difference;
  const double length = line.norm();
  if (!(length > 1e-140)) return {};
  const Vector towardsFirst = line / length;
  std::array<double, 4> place, speed;
  double size = 0, fastest = 0;
  for (int i = 0; i < 4; ++i) {
    place[i] = towardsFirst.dot(x[i] - x[0]);
    speed[i] = towardsFirst.dot(motion[i] - motion[0]);
    size = std::max({size, x[i].lpNorm<Eigen::Infinity>(), std::abs(place[i])});
    fastest = std::max(fastest, motion[i].lpNorm<Eigen::Infinity>());
  }
  const bool edges = kind == PairKind::EdgeEdge;
  const auto split = [&](const std::array<double, 4>& of) {
    const double first = edges ? std::min(of[0], of[1]) : of[0];
    const double second = edges ? std::max(of[2], of[3]) : std::max({of[1], of[2], of[3]});
    return first - second;
  };
  constexpr double kRound = 1e-14;  // of the size: some tens of roundings
  return {split(place) - kRound * size, -split(speed) + kRound * fastest};
}

/// Four points as the volume that they span: a . (u x v), |u x v| times the distance from the
/// vertex to the face's plane, or between the lines of the two edges.
struct Span {
  Vector a, u, v;
};

Span spanOf(PairKind kind, const FourPoints& x) {
  if (kind == PairKind::VertexFace) return {x[0] - x[1], x[2] - x[1], x[3] - x[1]};
  return {x[0] - x[2], x[1] - x[0], x[3] - x[2]};
}

double volumeOf(const Vector& a, const Vector& u, const Vector& v) {
  return a.dot(u.cross(v));
}

/// Whether the plane of a face, or the lines of two edges, provably stay farther than `gap` from
/// the vertex or from each other, from x to y on straight ways.
///
/// The volume is a cubic of time and u x v a quadratic: both stay within the hull of their
/// Bernstein coefficients.  Unlike planes that keep their direction, this bound follows a pair that
/// turns.
bool staysApart(PairKind kind, const FourPoints& x, const FourPoints& y, double gap) {
  const Span s = spanOf(kind, x), e = spanOf(kind, y);
  const std::array<double, 4> volume = {
      volumeOf(s.a, s.u, s.v),
      (volumeOf(e.a, s.u, s.v) + volumeOf(s.a, e.u, s.v) + volumeOf(s.a, s.u, e.v)) / 3,
      (volumeOf(s.a, e.u, e.v) + volumeOf(e.a, s.u, e.v) + volumeOf(e.a, e.u, s.v)) / 3,
      volumeOf(e.a, e.u, e.v)};
  const auto [least, most] = std::ranges::minmax_element(volume);
  const double room = *least > 0 ? *least : -*most;
  if (!(room > 0)) return false;
  const double area = std::sqrt(std::max({s.u.cross(s.v).squaredNorm(),
                                          (0.5 * (s.u.cross(e.v) + e.u.cross(s.v))).squaredNorm(),
                                          e.u.cross(e.v).squaredNorm()}));
  double size = 0;
  for (int i = 0; i < 4; ++i) {
    size = std::max({size, x[i].lpNorm<Eigen::Infinity>(), y[i].lpNorm<Eigen::Infinity>()});
  }
  constexpr double kRound = 1e-13;  // some hundreds of roundings
  const double lengths = std::sqrt(std::max(s.u.squaredNorm(), e.u.squaredNorm()) *
                                   std::max(s.v.squaredNorm(), e.v.squaredNorm()));
  return room - kRound * size * lengths > kRoundUp * gap * area;
}

}  // namespace

double approachBound(PairKind kind, const FourPoints& motion) {
  // Any two points of the features part or approach no faster than the fastest two corners.
  const int split = kind == PairKind::VertexFace ? 1 : 2;
  double bound = 0, size = 0;
  for (int i = 0; i < split; ++i) {
    for (int j = split; j < 4; ++j) bound = std::max(bound, (motion[i] - motion[j]).squaredNorm());
  }
  for (int i = 0; i < 4; ++i) size = std::max(size, motion[i].lpNorm<Eigen::Infinity>());
  return kRoundUp * std::sqrt(bound) + 1e-15 * size;
}

double safeTime(PairKind kind, const FourPoints& x, const FourPoints& motion, double limit,
                const AdvanceOptions& options) {
  // What moves as one keeps its distances, even where floating point cannot tell them from zero.
  if (motion[0] == motion[1] && motion[0] == motion[2] && motion[0] == motion[3]) return limit;
  const double speed = approachBound(kind, motion);
  const double start = distanceBound(kind, x);
  if (!(start > 0)) return 0;
  const double gap = options.gap(start);
  if (speed * limit <= start - gap) return limit;

  // Time in which the distance cannot fall to the gap, whatever the features do in between.
  const auto freeTime = [&](const FourPoints& now, double distance) {
    const AlongLine line = alongLine(kind, now, motion);
    const double all = (distance - gap) / speed;
    if (!(line.separation > gap)) return all;
    return line.closing > 0 ? std::max(all, (line.separation - gap) / line.closing) : kInfinity;
  };
  double time = 0, distance = start;
  FourPoints now = x;
  // Time that the pair stays apart as the volume between its points tells, 0 if it does not.
  const auto turningTime = [&](double atLeast) {
    constexpr double kShorter = 0.25;
    for (double ahead = limit - time; ahead > atLeast; ahead *= kShorter) {
      FourPoints then;
      for (int i = 0; i < 4; ++i) then[i] = x[i] + (time + ahead) * motion[i];
      if (staysApart(kind, now, then, gap)) return ahead;
    }
    return 0.0;
  };
  for (int n = 0; n < kMostAdvances; ++n) {
    const double straight = kAdvanceShare * freeTime(now, distance);
    if (time + straight >= limit) return limit;
    const double next = time + std::max(straight, turningTime(straight));
    if (next >= limit) return limit;
    if (next <= time) return time;  // no advance left that floating point can tell
    const bool small = next - time < kSmallAdvance * limit;
    for (int i = 0; i < 4; ++i) now[i] = x[i] + next * motion[i];
    time = next;
    const double before = std::exchange(distance, distanceBound(kind, now));
    // Pairs almost in contact that open start with small advances, which grow.
    if (distance <= gap || (small && distance <= before)) return time;
  }
  return time;
}

}  // namespace explica::collision
