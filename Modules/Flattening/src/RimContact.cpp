// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/RimContact.h"

#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/Predicates.h"

#include <algorithm>
#include <cmath>

namespace explica::flattening {
namespace {

using Plane = Eigen::Vector2d;

Plane at(const FlatPositions& flat, std::int32_t v) {
  return flat.row(v).transpose();
}

double crossProduct(const Plane& a, const Plane& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Place along the segment from a to b of its point nearest to p, in [0, 1].
double nearestPlace(const Plane& p, const Plane& a, const Plane& b) {
  const double squared = (b - a).squaredNorm();
  return squared > 0 ? std::clamp((p - a).dot(b - a) / squared, 0.0, 1.0) : 0.0;
}

geometry::Box boxOf(std::initializer_list<Plane> points, double margin) {
  geometry::Box box;
  for (const Plane& p : points) box.extend(Point(p.x(), p.y(), 0));
  box.min().array() -= margin;
  box.max().array() += margin;
  return box;
}

/// First time in [0, 1] at which a moving point lies on a moving segment; infinity if never.
double meetingTime(const Plane& p, const Plane& a, const Plane& b, const Plane& dp, const Plane& da,
                   const Plane& db) {
  constexpr double kSlack = 1e-9;  // of the edge: a point that passes an end counts as meeting
  const Plane u = b - a, v = p - a, du = db - da, dv = dp - da;
  const double c0 = crossProduct(u, v), c1 = crossProduct(u, dv) + crossProduct(du, v),
               c2 = crossProduct(du, dv);
  const double discriminant = c1 * c1 - 4 * c0 * c2;
  if (discriminant < 0) return kInfinity;
  const double w = -(c1 + std::copysign(std::sqrt(discriminant), c1)) / 2;
  double first = kInfinity;
  for (const double t : {c2 != 0 ? w / c2 : kInfinity, w != 0 ? c0 / w : kInfinity}) {
    if (!(t >= 0 && t <= 1) || t >= first) continue;
    const Plane ut = u + t * du, vt = v + t * dv;
    const double along = vt.dot(ut), squared = ut.squaredNorm();
    if (along >= -kSlack * squared && along <= (1 + kSlack) * squared) first = t;
  }
  return first;
}

}  // namespace

RimContact::RimContact(Loop rim, const std::vector<double>& lengths, double range)
    : rim_(std::move(rim)), range_(rim_.size()) {
  constexpr double kShareOfEdge = 0.25;  // neighbours along a rim bent sharply stay out of range
  for (std::size_t n = 0; n < rim_.size(); ++n) {
    const double shorter = std::min(lengths[n], lengths[(n + rim_.size() - 1) % rim_.size()]);
    range_[n] = std::max(std::min(range, kShareOfEdge * shorter), 1e-3 * range);
  }
}

std::vector<RimContact::Pair> RimContact::near(const FlatPositions& flat) const {
  const std::size_t count = rim_.size();
  std::vector<geometry::Box> boxes(count);
  for (std::size_t n = 0; n < count; ++n) {
    boxes[n] = boxOf({at(flat, rim_[n]), at(flat, rim_[(n + 1) % count])}, 0);
  }
  const geometry::BoxTree tree(boxes);
  std::vector<Pair> pairs;
  for (std::size_t n = 0; n < count; ++n) {
    const Plane p = at(flat, rim_[n]);
    const std::size_t first = pairs.size();
    tree.forOverlaps(boxOf({p}, range_[n]), [&](std::int32_t e) {
      const std::size_t end = (static_cast<std::size_t>(e) + 1) % count;
      if (static_cast<std::size_t>(e) == n || end == n) return;
      const Plane a = at(flat, rim_[e]), b = at(flat, rim_[end]);
      if ((a + nearestPlace(p, a, b) * (b - a) - p).norm() < range_[n]) {
        pairs.push_back({static_cast<std::int32_t>(n), e});
      }
    });
    std::sort(pairs.begin() + static_cast<std::ptrdiff_t>(first), pairs.end(),
              [](const Pair& a, const Pair& b) { return a.edge < b.edge; });
  }
  return pairs;
}

double RimContact::value(const FlatPositions& flat) const {
  double sum = 0;
  for (const Pair& pair : near(flat)) {
    const Plane p = at(flat, rim_[pair.vertex]), a = at(flat, rim_[pair.edge]);
    const Plane b = at(flat, rim_[(pair.edge + 1) % rim_.size()]);
    const double r = range_[pair.vertex];
    const double s = (a + nearestPlace(p, a, b) * (b - a) - p).squaredNorm() / (r * r);
    if (!(s > 0)) return kInfinity;
    if (s < 1) sum += -(s - 1) * (s - 1) * std::log(s);
  }
  return sum;
}

RimContact::PairTerm RimContact::term(const FlatPositions& flat, const Pair& pair) const {
  PairTerm term;
  term.vertices = {rim_[pair.vertex], rim_[pair.edge], rim_[(pair.edge + 1) % rim_.size()]};
  const Plane p = at(flat, term.vertices[0]), a = at(flat, term.vertices[1]);
  const Plane b = at(flat, term.vertices[2]);
  const double place = nearestPlace(p, a, b);
  const Plane apart = p - a - place * (b - a);
  const double distance = apart.norm(), r = range_[pair.vertex];
  const Plane normal = apart / distance;
  term.direction << normal, -(1 - place) * normal, -place * normal;
  const double s = distance * distance / (r * r);
  const double slope = -2 * (s - 1) * std::log(s) - (s - 1) * (s - 1) / s;
  const double bend = -2 * std::log(s) - 4 * (s - 1) / s + (s - 1) * (s - 1) / (s * s);
  // By the distance instead of its square: s = d^2 / r^2.
  const double sd = 2 * distance / (r * r);
  term.gradient = slope * sd * term.direction;
  term.bend = std::max(0.0, bend * sd * sd + slope * 2 / (r * r));
  return term;
}

double RimContact::largestStep(const FlatPositions& flat, const FlatPositions& step) const {
  const std::size_t count = rim_.size();
  const auto moved = [&](std::int32_t v) -> Plane { return at(flat, v) + at(step, v); };
  std::vector<geometry::Box> boxes(count);
  for (std::size_t n = 0; n < count; ++n) {
    const std::int32_t a = rim_[n], b = rim_[(n + 1) % count];
    boxes[n] = boxOf({at(flat, a), at(flat, b), moved(a), moved(b)}, 0);
  }
  const geometry::BoxTree tree(boxes);
  double first = kInfinity;
  for (std::size_t n = 0; n < count; ++n) {
    const std::int32_t v = rim_[n];
    tree.forOverlaps(boxOf({at(flat, v), moved(v)}, 0), [&](std::int32_t e) {
      const std::int32_t a = rim_[e], b = rim_[(static_cast<std::size_t>(e) + 1) % count];
      if (a == v || b == v) return;
      first = std::min(first, meetingTime(at(flat, v), at(flat, a), at(flat, b), at(step, v),
                                          at(step, a), at(step, b)));
    });
  }
  return std::min(1.0, kShareOfWay * first);
}

std::vector<std::array<std::int32_t, 2>> rimCrossings(const Loop& rim, const FlatPositions& flat) {
  const std::size_t count = rim.size();
  std::vector<geometry::Box> boxes(count);
  for (std::size_t n = 0; n < count; ++n) {
    boxes[n] = boxOf({at(flat, rim[n]), at(flat, rim[(n + 1) % count])}, 0);
  }
  std::vector<std::array<std::int32_t, 2>> crossings;
  for (const auto& pair : geometry::BoxTree(boxes).overlappingPairs()) {
    const std::int32_t a = rim[pair[0]], b = rim[(pair[0] + 1) % count];
    const std::int32_t c = rim[pair[1]], d = rim[(pair[1] + 1) % count];
    const Plane pa = at(flat, a), pb = at(flat, b), pc = at(flat, c), pd = at(flat, d);
    if (b == c || d == a) {  // neighbours meet if the second runs back along the first
      const Plane corner = b == c ? pb : pa;
      const Plane from = b == c ? pa : pb, to = b == c ? pd : pc;
      if (geometry::orientation(from, corner, to) == 0 && (from - corner).dot(to - corner) > 0) {
        crossings.push_back(pair);
      }
      continue;
    }
    const int abc = geometry::orientation(pa, pb, pc), abd = geometry::orientation(pa, pb, pd);
    const int cda = geometry::orientation(pc, pd, pa), cdb = geometry::orientation(pc, pd, pb);
    // Boxes overlap, so that four collinear ends mean an overlap of the segments.
    if (abc * abd <= 0 && cda * cdb <= 0) crossings.push_back(pair);
  }
  return crossings;
}

}  // namespace explica::flattening
