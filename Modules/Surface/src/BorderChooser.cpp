// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "BorderChooser.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/Types.h"
#include "PathProfile.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace explica::surface {
namespace {

/// An edge is there if brightness comes so near to its level, in contrasts.
constexpr float kNear = 0.3F;
/// Places on each side over which a slope is taken, and how often it is averaged over neighbours.
constexpr int kSlope = 3, kSlopeRings = 3;

}  // namespace

BorderChooser::BorderChooser(std::vector<Profile> misses, std::vector<Choice> choices,
                             const geometry::MeshTopology& topology, double step, double length,
                             const ChoiceCosts& costs)
    : misses_(std::move(misses)),
      choices_(std::move(choices)),
      topology_(topology),
      step_(step),
      length_(length),
      costs_(costs),
      has_(misses_.size()) {
  for (std::size_t v = 0; v < has_.size(); ++v) has_[v] = comesNear(v);
  for (int place = 0; place < kPlaces; ++place) ways_[place] = (place - kSide) * step / length;
}

Eigen::VectorXd BorderChooser::choose(int rounds) const {
  Eigen::VectorXd chosen = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(misses_.size()));
  for (int round = 0; round < rounds; ++round) {
    Eigen::VectorXd next(chosen.size());
    parallelFor(misses_.size(), 512, [&](std::size_t v) {
      double mean = 0;
      const auto& ring = topology_.vertexVertices[v];
      for (const std::int32_t w : ring) mean += chosen[w] / static_cast<double>(ring.size());
      next[static_cast<Eigen::Index>(v)] = has_[v] ? bestOf(v, mean) : 0.0;
    });
    chosen = std::move(next);
  }
  return chosen;
}

Eigen::VectorXd BorderChooser::deviations(const Eigen::VectorXd& chosen,
                                          const Eigen::VectorXd& noise, double most) const {
  Eigen::VectorXd slopes(chosen.size()), left(chosen.size());
  parallelFor(misses_.size(), 512, [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    const int place = std::clamp(kSide + static_cast<int>(std::lround(chosen[row] / step_)), kSlope,
                                 kPlaces - 1 - kSlope);
    left[row] = misses_[v][place];
    slopes[row] = (misses_[v][place - kSlope] - misses_[v][place + kSlope]) / (2 * kSlope * step_);
  });
  slopes = averaged(slopes, topology_, kSlopeRings);
  Eigen::VectorXd result(chosen.size());
  parallelFor(misses_.size(), 512, [&](std::size_t v) {
    const auto row = static_cast<Eigen::Index>(v);
    const double deviation = std::hypot(noise[row], left[row]) / slopes[row];
    result[row] = has_[v] && deviation > 0 ? std::min(deviation, most) : most;
  });
  return result;
}

Eigen::VectorXd BorderChooser::missing() const {
  const Eigen::Map<const Eigen::VectorX<std::uint8_t>> has(has_.data(),
                                                           static_cast<Eigen::Index>(has_.size()));
  return 1 - has.cast<double>().array();
}

bool BorderChooser::comesNear(std::size_t v) const {
  for (int k = choices_[v].first; k <= choices_[v].last; ++k) {
    if (std::abs(misses_[v][k]) < kNear) return true;
  }
  return false;
}

double BorderChooser::bestOf(std::size_t v, double mean) const {
  const double usual = mean / length_;
  std::array<double, kPlaces> costs;
  for (int place = 0; place < kPlaces; ++place) {
    const float miss = misses_[v][place];
    const double way = ways_[place], off = way - usual;
    costs[place] =
        std::min(1.0F, miss * miss) + costs_.centring * way * way + costs_.smoothness * off * off;
  }
  const Choice& choice = choices_[v];
  int best = -1;
  double least = kInfinity;
  for (int place = choice.first; place <= choice.last; ++place) {
    if (!(costs[place] < least)) continue;
    least = costs[place];
    best = place;
  }
  if (best < 0) return 0;
  double shift = 0;  // of the parabola through the best place and its neighbours
  if (best > choice.first && best < choice.last) {
    const double before = costs[best - 1], after = costs[best + 1];
    const double bend = before - 2 * least + after;
    if (bend > 0) shift = std::clamp(0.5 * (before - after) / bend, -0.5, 0.5);
  }
  return (best + shift - kSide) * step_;
}

}  // namespace explica::surface
