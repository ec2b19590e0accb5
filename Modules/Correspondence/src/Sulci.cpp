// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Sulci.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <sstream>

namespace explica::correspondence {

using harmonic::Annulus;
using harmonic::Cut;
using harmonic::kInner;
using harmonic::kOuter;

namespace {

/// For each tissue voxel the nearest point of the inner boundary, mm along the axes from the box's
/// origin; found by carrying points from voxel to voxel in order of distance.
struct Fronts {
  std::vector<Vector> source;
  std::vector<double> distance;
};

Fronts frontsFromInside(const Annulus& annulus) {
  const Vector& h = annulus.grid.spacing;
  Fronts fronts;
  fronts.source.assign(annulus.count(), Vector::Constant(kNaN));
  fronts.distance.assign(annulus.count(), kInfinity);
  using Entry = std::pair<double, std::int32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto centre = [&](std::int32_t n) {
    const auto s = annulus.boxSubscripts(n);
    return Vector(Vector(s[0], s[1], s[2]).cwiseProduct(h));
  };
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    const std::int32_t row = annulus.irregular(n);
    if (row < 0) continue;
    // The boundary's plane through its crossings of the axes: its nearest point is the foot of the
    // perpendicular, 1/d^2 = sum 1/d_a^2.
    Vector inverse = Vector::Zero();
    for (int d = 0; d < 6; ++d) {
      if (annulus.links[n][d] != kInner) continue;
      const int a = harmonic::axisOf(d);
      const double reach = harmonic::signOf(d) * annulus.fractions[row][d] * h[a];
      if (inverse[a] == 0 || std::abs(reach) < std::abs(1 / inverse[a])) inverse[a] = 1 / reach;
    }
    const double squared = inverse.squaredNorm();
    if (squared == 0) continue;
    fronts.source[n] = centre(n) + inverse / squared;
    fronts.distance[n] = 1 / std::sqrt(squared);
    queue.emplace(fronts.distance[n], n);
  }
  std::vector<std::uint8_t> done(annulus.count(), 0);
  while (!queue.empty()) {
    const auto [distance, n] = queue.top();
    queue.pop();
    if (done[n] || distance > fronts.distance[n]) continue;
    done[n] = 1;
    // Along links only: so every voxel hangs together with its source through voxels of the same
    // source, between which no sheet can come.
    for (int d = 0; d < 6; ++d) {
      const std::int32_t m = annulus.links[n][d];
      if (m < 0 || done[m]) continue;
      const double there = (centre(m) - fronts.source[n]).norm();
      if (there < fronts.distance[m]) {
        fronts.distance[m] = there;
        fronts.source[m] = fronts.source[n];
        queue.emplace(there, m);
      }
    }
  }
  return fronts;
}

/// Pieces of tissue joined by uncut links; true for those that touch the inner boundary.
std::vector<std::uint8_t> reachesInside(const Annulus& annulus) {
  std::vector<std::uint8_t> reached(annulus.count(), 0);
  std::vector<std::int32_t> stack;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    for (int d = 0; d < 6 && !reached[n]; ++d) {
      if (annulus.links[n][d] != kInner) continue;
      reached[n] = 1;
      stack.push_back(n);
    }
  }
  while (!stack.empty()) {
    const std::int32_t n = stack.back();
    stack.pop_back();
    for (int d = 0; d < 6; ++d) {
      const std::int32_t m = annulus.links[n][d];
      if (m >= 0 && !reached[m]) {
        reached[m] = 1;
        stack.push_back(m);
      }
    }
  }
  return reached;
}

}  // namespace

SulcalRecovery recoverSulci(const Annulus& annulus, const SulcusOptions& options,
                            const Monitor& monitor) {
  if (!(options.facingDeg > 0 && options.facingDeg < 180)) {
    throw InvalidInput("the facing angle must lie between 0 and 180 degrees");
  }
  monitor.progress(0, "buried sulci");
  const Fronts fronts = frontsFromInside(annulus);
  const Vector& h = annulus.grid.spacing;
  const double facing = std::cos(options.facingDeg * kPi / 180);
  std::vector<Cut> cuts;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    const auto s = annulus.boxSubscripts(n);
    const Vector x = Vector(s[0], s[1], s[2]).cwiseProduct(h);
    for (int a = 0; a < 3; ++a) {
      const std::int32_t m = annulus.links[n][2 * a + 1];
      if (m < 0 || !std::isfinite(fronts.distance[n]) || !std::isfinite(fronts.distance[m]))
        continue;
      const Vector y = x + h[a] * Vector::Unit(a);
      const Vector from = x - fronts.source[n], to = y - fronts.source[m];
      // The fronts run against each other, and not away from the link between them.  Along a
      // sheet that is in the grid's planes they run across the link: where one voxel of the middle
      // was reached from one bank and the next from the other, the sheet passes between them.
      if (from[a] < 0 && to[a] > 0) continue;
      if (from.dot(to) > facing * from.norm() * to.norm()) continue;
      // Where |x + t h e - p| = |x + t h e - q|.
      const Vector p = fronts.source[n], q = fronts.source[m];
      const double slope = 2 * h[a] * (q[a] - p[a]);
      const double t = slope > 0 ? ((x - q).squaredNorm() - (x - p).squaredNorm()) / slope : 0.5;
      cuts.push_back({n, a, std::clamp(t, 0.02, 0.98)});
    }
  }
  SulcalRecovery result;
  result.annulus = harmonic::withCuts(annulus, cuts);
  // A piece cut off from the inner boundary has no trajectory: join it again.
  const auto reached = reachesInside(result.annulus);
  const auto strides = annulus.strides();
  const auto reachedOld = [&](std::int32_t n) {
    return reached[result.annulus.numberAt[annulus.place[n]]] != 0;
  };
  const std::size_t before = cuts.size();
  std::erase_if(cuts, [&](const Cut& cut) {
    const std::int32_t m = annulus.numberAt[annulus.place[cut.number] + strides[cut.axis]];
    return !reachedOld(cut.number) || !reachedOld(m);
  });
  if (cuts.size() != before) result.annulus = harmonic::withCuts(annulus, cuts);

  const Annulus& made = result.annulus;
  std::vector<std::uint8_t> touched(made.count(), 0);
  for (const Cut& cut : cuts) {
    const std::int32_t p = annulus.place[cut.number];
    touched[made.numberAt[p]] = touched[made.numberAt[p + strides[cut.axis]]] = 1;
    result.sheet.push_back(
        annulus.grid.toWorld(annulus.index(cut.number) + cut.fraction * Vector::Unit(cut.axis)));
  }
  for (std::size_t n = 0; n < made.count(); ++n) {
    if (touched[n]) result.voxels.push_back(static_cast<std::int32_t>(n));
  }
  monitor.progress(1, "buried sulci");
  return result;
}

}  // namespace explica::correspondence
