// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/Sulci.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace explica::correspondence {

using harmonic::Annulus;
using harmonic::Cut;
using harmonic::kInner;
using harmonic::kOuter;

namespace {

constexpr std::size_t kGrain = 1 << 9;  // elements a task
// Fronts advance by this share of the finest spacing at a time: a voxel keeps a source that is
// farther than another by no more than that.
constexpr double kAdvance = 0.125;

/// For each tissue voxel the nearest point of the inner boundary, carried from voxel to voxel in
/// order of distance.
struct Fronts {
  std::vector<Vector> feet;           ///< those points, mm along the axes from the box's origin
  std::vector<std::int32_t> nearest;  ///< per tissue voxel, its foot; -1: not reached
};

/// A voxel's distance and foot in one word, so that the smaller of two is the nearer one, or of
/// equally near ones the first.
using Reach = std::uint64_t;
constexpr Reach kUnreached = std::numeric_limits<Reach>::max();  // beyond every way

Reach reachOf(double distance, std::int32_t foot) {
  return static_cast<Reach>(std::bit_cast<std::uint32_t>(static_cast<float>(distance))) << 32 |
         static_cast<std::uint32_t>(foot);
}
double distanceOf(Reach reach) {
  return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(reach >> 32)));
}
std::int32_t footOf(Reach reach) {
  return static_cast<std::int32_t>(reach & 0xffffffffU);
}
/// A settled voxel's reach has the distance zero, so that nothing is nearer.
Reach settled(Reach reach) {
  return reach & 0xffffffffU;
}
bool isSettled(Reach reach) {
  return reach >> 32 == 0;
}

/// Foot of the perpendicular on the boundary's plane through its crossings of the axes, relative to
/// the voxel's centre: 1/d^2 = sum 1/d_a^2.  Zero if the voxel is not beside the inner boundary.
Vector footBeside(const Annulus& annulus, std::int32_t n) {
  const std::int32_t row = annulus.irregular(n);
  Vector inverse = Vector::Zero();
  for (int d = 0; row >= 0 && d < 6; ++d) {
    if (annulus.links[n][d] != kInner) continue;
    const int a = harmonic::axisOf(d);
    const double reach = harmonic::signOf(d) * annulus.fractions[row][d] * annulus.grid.spacing[a];
    if (inverse[a] == 0 || std::abs(reach) < std::abs(1 / inverse[a])) inverse[a] = 1 / reach;
  }
  const double squared = inverse.squaredNorm();
  return squared > 0 ? Vector(inverse / squared) : inverse;
}

/// Has what a front's next voxels read brought from memory: they lie all over the tissue.
void askFor(const Annulus& annulus, const std::vector<Reach>& reach,
            const std::vector<std::int32_t>& front, std::size_t k) {
  constexpr std::size_t kLinksAhead = 16, kReachAhead = 8;
  if (k + kLinksAhead < front.size()) {
    __builtin_prefetch(annulus.links[front[k + kLinksAhead]].data());
    __builtin_prefetch(&annulus.place[front[k + kLinksAhead]]);
  }
  if (k + kReachAhead < front.size()) {
    for (const std::int32_t m : annulus.links[front[k + kReachAhead]]) {
      if (m >= 0) __builtin_prefetch(&reach[m]);
    }
  }
}

Fronts frontsFromInside(const Annulus& annulus) {
  const Vector& h = annulus.grid.spacing;
  const double width = kAdvance * (annulus.planar ? h.head<2>().minCoeff() : h.minCoeff());
  const auto centre = [&](const std::array<std::int32_t, 3>& s) {
    return Vector(Vector(s[0], s[1], s[2]).cwiseProduct(h));
  };
  Fronts fronts;
  std::vector<Reach> reach(annulus.count(), kUnreached);
  std::vector<std::vector<std::int32_t>> waiting;  // by distance; some are there in vain
  std::size_t shell = 0;
  const auto wait = [&](std::int32_t n) {
    const std::size_t at = std::max(shell, static_cast<std::size_t>(distanceOf(reach[n]) / width));
    if (at >= waiting.size()) waiting.resize(at + 1);
    waiting[at].push_back(n);
  };
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    const Vector foot = footBeside(annulus, n);
    if (foot.isZero(0)) continue;
    reach[n] = reachOf(foot.norm(), static_cast<std::int32_t>(fronts.feet.size()));
    fronts.feet.emplace_back(centre(annulus.boxSubscripts(n)) + foot);
    wait(n);
  }
  std::vector<std::int32_t> front;
  std::vector<std::vector<std::int32_t>> nearer;
  while (shell < waiting.size()) {
    // Voxels of a shell are settled together; those that they bring into it are the next front.
    front.clear();
    for (const std::int32_t n : waiting[shell]) {
      if (isSettled(reach[n])) continue;
      reach[n] = settled(reach[n]);
      front.push_back(n);
    }
    waiting[shell].clear();
    if (front.empty()) {
      ++shell;
      continue;
    }
    // Along links only: so every voxel hangs together with its source through voxels of the same
    // source, between which no sheet can come.
    nearer.assign((front.size() + kGrain - 1) / kGrain, {});
    parallelForBlocks(front.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      std::vector<std::int32_t>& own = nearer[begin / kGrain];
      for (std::size_t k = begin; k < end; ++k) {
        askFor(annulus, reach, front, k);
        const std::int32_t n = front[k];
        const auto at = annulus.boxSubscripts(n);
        const std::int32_t foot = footOf(reach[n]);
        const Vector here = centre(at), from = fronts.feet[foot];
        for (int d = 0; d < 6; ++d) {
          const std::int32_t m = annulus.links[n][d];
          if (m < 0) continue;
          const std::atomic_ref<Reach> held(reach[m]);
          Reach known = held.load(std::memory_order_relaxed);
          if (isSettled(known)) continue;
          const int a = harmonic::axisOf(d);
          Vector there = here;
          there[a] = (at[a] + harmonic::signOf(d)) * h[a];
          const Reach offered = reachOf((there - from).norm(), foot);
          while (offered < known &&
                 !held.compare_exchange_weak(known, offered, std::memory_order_relaxed)) {
          }
          if (offered < known) own.push_back(m);
        }
      }
    });
    for (const auto& part : nearer) {
      for (const std::int32_t m : part) wait(m);
    }
  }
  fronts.nearest.resize(annulus.count());
  parallelFor(annulus.count(), 1 << 14, [&](std::size_t n) {
    fronts.nearest[n] = reach[n] == kUnreached ? -1 : footOf(reach[n]);
  });
  return fronts;
}

/// Where fronts that face each other meet.
std::vector<Cut> meetingsOf(const Annulus& annulus, const Fronts& fronts, double facing) {
  constexpr std::size_t kBlock = 1 << 12;  // voxels a task
  const Vector& h = annulus.grid.spacing;
  std::vector<std::vector<Cut>> parts((annulus.count() + kBlock - 1) / kBlock);
  parallelFor(annulus.count(), kBlock, [&](std::size_t number) {
    const auto n = static_cast<std::int32_t>(number);
    const std::int32_t one = fronts.nearest[n];
    if (one < 0) return;
    const auto s = annulus.boxSubscripts(n);
    const Vector x = Vector(s[0], s[1], s[2]).cwiseProduct(h);
    for (int a = 0; a < 3; ++a) {
      const std::int32_t m = annulus.links[n][2 * a + 1];
      const std::int32_t two = m < 0 ? -1 : fronts.nearest[m];
      if (two < 0 || two == one) continue;
      const Vector p = fronts.feet[one], q = fronts.feet[two];
      const Vector from = x - p, to = x + h[a] * Vector::Unit(a) - q;
      // The fronts run against each other, and not away from the link between them.  Along a
      // sheet that is in the grid's planes they run across the link: where one voxel of the middle
      // was reached from one bank and the next from the other, the sheet passes between them.
      if (from[a] < 0 && to[a] > 0) continue;
      if (from.dot(to) > facing * from.norm() * to.norm()) continue;
      // Where |x + t h e - p| = |x + t h e - q|.
      const double slope = 2 * h[a] * (q[a] - p[a]);
      const double t = slope > 0 ? ((x - q).squaredNorm() - (x - p).squaredNorm()) / slope : 0.5;
      const double place = std::clamp(t, 0.02, 0.98);
      parts[number / kBlock].push_back({n, a, place, 1 - place});
    }
  });
  std::vector<Cut> cuts;
  for (const auto& part : parts) cuts.insert(cuts.end(), part.begin(), part.end());
  return cuts;
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

SulcalRecovery recoverSulci(Annulus annulus, const SulcusOptions& options, const Monitor& monitor) {
  if (!(options.facingDeg > 0 && options.facingDeg < 180)) {
    throw InvalidInput("the facing angle must lie between 0 and 180 degrees");
  }
  monitor.progress(0, "buried sulci");
  std::vector<Cut> cuts =
      meetingsOf(annulus, frontsFromInside(annulus), std::cos(options.facingDeg * kPi / 180));
  SulcalRecovery result;
  if (cuts.empty()) {
    monitor.progress(1, "buried sulci");
    result.annulus = std::move(annulus);
    return result;
  }
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
