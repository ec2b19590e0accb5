// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "RotationSearch.h"

#include "Explica/Core/Parallel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::sphere {
namespace {

constexpr int kRotations = 4000;           // some 14 degrees apart
constexpr std::size_t kFollowed = 14;      // of them, best first, no two of them near
constexpr double kApart = 16 * kPi / 180;  // radians: a little more than between neighbours
constexpr int kLevel = 2;                  // of the pyramids: 162 vertices, 16 degrees apart

struct Candidate {
  Eigen::Quaterniond rotation;
  double cost = kInfinity;
};

/// Rotations spread evenly over all [Alexa2022, Algorithm 1], and their inverses.
Eigen::Quaterniond rotationOf(int number) {
  const int n = number / 2;
  const double phi = std::sqrt(2.0), psi = 1.533751168755204288118041;
  const double s = n + 0.5, t = 2 * s / kRotations, d = 2 * kPi * s;
  const double r = std::sqrt(t), q = std::sqrt(1 - t);
  const Eigen::Quaterniond one(r * std::sin(d / phi), r * std::cos(d / phi), q * std::sin(d / psi),
                               q * std::cos(d / psi));
  return number % 2 == 0 ? one : one.conjugate();
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

/// The best candidates of which none is near a better one.
std::vector<Candidate> apart(const std::vector<Candidate>& sorted) {
  std::vector<Candidate> kept;
  for (const Candidate& one : sorted) {
    const bool near = std::ranges::any_of(kept, [&](const Candidate& better) {
      return better.rotation.angularDistance(one.rotation) < kApart;
    });
    if (!near) kept.push_back(one);
    if (kept.size() == kFollowed) break;
  }
  return kept;
}

}  // namespace

std::vector<Eigen::Matrix3d> searchRotations(const std::vector<FoldingLevel>& moving,
                                             const std::vector<FoldingLevel>& target,
                                             const Monitor& monitor) {
  monitor.progress(0, "rotation");
  std::vector<Candidate> candidates(kRotations);
  parallelFor(candidates.size(), 16, [&](std::size_t n) {
    const Eigen::Quaterniond rotation = rotationOf(static_cast<int>(n));
    candidates[n] = {rotation, costOf(moving[kLevel], target[kLevel], rotation) +
                                   costOf(target[kLevel], moving[kLevel], rotation.conjugate())};
  });
  std::ranges::stable_sort(candidates, {}, &Candidate::cost);
  std::vector<Eigen::Matrix3d> rotations;
  for (const Candidate& one : apart(candidates))
    rotations.push_back(one.rotation.toRotationMatrix());
  rotations.emplace_back(Eigen::Matrix3d::Identity());
  return rotations;
}

}  // namespace explica::sphere
