// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "RotationSearch.h"

#include "Explica/Core/Parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::sphere {
namespace {

constexpr int kRotations = 4000;              // some 14 degrees apart
constexpr std::size_t kFollowed = 30;         // of them, best first, no two of them near
constexpr double kFirstStep = 8 * kPi / 180;  // half of what is between neighbours
constexpr double kLastStep =
    0.02 * kPi / 180;  // radians: a fifth of what a sphere may move onto itself
constexpr int kCoarse = 2, kMiddle = 3, kFine = 5;  // levels of the pyramids

struct Candidate {
  Eigen::Quaterniond rotation;
  double cost = kInfinity;
};

/// Rotations spread evenly over all [Alexa2022, Algorithm 1].
Eigen::Quaterniond spiralRotation(int n) {
  const double phi = std::sqrt(2.0), psi = 1.533751168755204288118041;
  const double s = n + 0.5, t = s / kRotations, d = 2 * kPi * s;
  const double r = std::sqrt(t), q = std::sqrt(1 - t);
  return {r * std::sin(d / phi), r * std::cos(d / phi), q * std::sin(d / psi),
          q * std::cos(d / psi)};
}

/// Mean squared difference where the target's vertices come from the moving sphere's places.
double costOf(const FoldingLevel& moving, const FoldingLevel& target,
              const Eigen::Quaterniond& rotation) {
  const Eigen::Matrix3d back = rotation.conjugate().toRotationMatrix();
  const Positions& x = target.grid->mesh().positions;
  double sum = 0;
  std::int32_t near = 0;
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    const auto place = moving.grid->locate(back * x.row(v).transpose(), near);
    near = place.face;
    for (std::size_t m = 0; m < 2; ++m) {
      double value = 0;
      for (int k = 0; k < 3; ++k)
        value += place.weights[k] * moving.maps[m][moving.grid->mesh().faces(place.face, k)];
      sum += target.weights[m][v] * (value - target.maps[m][v]) * (value - target.maps[m][v]);
    }
  }
  return sum / static_cast<double>(x.rows());
}

/// Turns about the three axes as long as that helps, by ever smaller angles.
Candidate descended(const FoldingLevel& moving, const FoldingLevel& target, Candidate at,
                    double step, double last) {
  at.cost = costOf(moving, target, at.rotation);
  for (; step >= last; step /= 2) {
    for (bool better = true; better;) {
      better = false;
      for (int n = 0; n < 6; ++n) {
        const double angle = n % 2 == 0 ? step : -step;
        const Eigen::Quaterniond turned =
            Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector::Unit(n / 2))) * at.rotation;
        const double cost = costOf(moving, target, turned);
        if (!(cost < at.cost)) continue;
        at = {turned.normalized(), cost};
        better = true;
      }
    }
  }
  return at;
}

/// The best candidates of which none is within twice the first step of a better one.
std::vector<Candidate> apart(const std::vector<Candidate>& sorted) {
  std::vector<Candidate> kept;
  for (const Candidate& one : sorted) {
    const bool near = std::any_of(kept.begin(), kept.end(), [&](const Candidate& better) {
      return better.rotation.angularDistance(one.rotation) < 2 * kFirstStep;
    });
    if (!near) kept.push_back(one);
    if (kept.size() == kFollowed) break;
  }
  return kept;
}

void sortByCost(std::vector<Candidate>& candidates) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
}

}  // namespace

std::vector<Eigen::Matrix3d> searchRotations(const std::vector<FoldingLevel>& moving,
                                             const std::vector<FoldingLevel>& target,
                                             const Monitor& monitor) {
  monitor.progress(0, "rotation");
  std::vector<Candidate> candidates(kRotations);
  parallelFor(candidates.size(), 16, [&](std::size_t n) {
    candidates[n].rotation = spiralRotation(static_cast<int>(n));
    candidates[n].cost = costOf(moving[kCoarse], target[kCoarse], candidates[n].rotation);
  });
  sortByCost(candidates);
  candidates = apart(candidates);
  const std::size_t fine = std::min<std::size_t>(kFine, target.size() - 1);
  Candidate best = candidates.front();
  best = descended(moving[kMiddle], target[kMiddle], best, kFirstStep, kFirstStep / 8);
  best = descended(moving[fine], target[fine], best, kFirstStep / 8, kLastStep);
  candidates.insert(candidates.begin(), best);
  std::vector<Eigen::Matrix3d> rotations;
  for (const Candidate& one : candidates) rotations.push_back(one.rotation.toRotationMatrix());
  rotations.emplace_back(Eigen::Matrix3d::Identity());
  return rotations;
}

}  // namespace explica::sphere
