// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Trend.h"

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

constexpr double kMostSteering = 1.15;  // factor of the visibility term a step
constexpr double kAim = 0.003;          // to spare of visibility, what tightening areas may cost

/// Where a quantity leads to whose steps shrink as the last two did [Aitken], by a quarter at
/// least.
double limitOf(const std::vector<IterationRecord>& history, double IterationRecord::*quantity) {
  constexpr double kSlowest = 0.75;
  const auto back = [&](std::size_t n) { return history[history.size() - 1 - n].*quantity; };
  const double step = back(0) - back(1), before = back(1) - back(2);
  const double ratio = before == 0 ? 0 : std::clamp(step / before, 0.0, kSlowest);
  return back(0) + ratio / (1 - ratio) * step;
}

}  // namespace

bool isSettled(const std::vector<IterationRecord>& history, int since) {
  constexpr std::size_t kWindow = 12;
  constexpr double kGain = 0.002;  // of visibility over the window
  if (history.back().iteration - since < static_cast<int>(kWindow)) return false;
  double best = -1, bestBefore = -1;
  for (std::size_t n = 0; n < history.size(); ++n) {
    const double v = history[n].visibility;
    best = std::max(best, v);
    if (n + kWindow < history.size()) bestBefore = std::max(bestBefore, v);
  }
  return best - bestBefore < kGain;
}

bool isRelaxed(const std::vector<IterationRecord>& history) {
  constexpr std::size_t kWindow = 5;
  if (history.size() <= kWindow) return false;
  const double before = history[history.size() - 1 - kWindow].edgeStrainMean;
  return history.back().edgeStrainMean > 0.996 * before;
}

double goalAt(double strain) {
  return kSeen + std::min(kAim, lengthsToSpare(strain));
}

Steering steer(const std::vector<IterationRecord>& history) {
  constexpr double kNear = 0.002;  // of visibility
  if (history.size() < 3) return {};
  const double visibility = std::min(1.0, limitOf(history, &IterationRecord::visibility));
  const double goal = goalAt(limitOf(history, &IterationRecord::edgeStrainMean));
  const double factor = std::sqrt((1 - visibility) / (1 - goal));
  return {std::clamp(factor, 1 / kMostSteering, kMostSteering), visibility > goal - kNear};
}

bool isGaining(const std::vector<IterationRecord>& history) {
  constexpr std::size_t kWindow = 5;
  return history.size() > kWindow &&
         history.back().visibility > history[history.size() - 1 - kWindow].visibility + kAim;
}

bool isAtRest(const std::vector<IterationRecord>& history) {
  constexpr std::size_t kWindow = 5;
  constexpr double kMove = 1e-4;
  if (history.size() <= kWindow) return false;
  const IterationRecord& last = history.back();
  const IterationRecord& before = history[history.size() - 1 - kWindow];
  return std::abs(last.visibility - before.visibility) < kMove &&
         std::abs(last.edgeStrainMean - before.edgeStrainMean) < kMove;
}

bool isTorn(const std::vector<IterationRecord>& history) {
  constexpr std::size_t kWindow = 5;
  const double now = history.back().collarStretchMax;
  if (history.size() <= kWindow) return now > kCollarMost;
  return now > kCollarMost && now < history[history.size() - 1 - kWindow].collarStretchMax;
}

double driveFactor(double visibility, double goal) {
  const double share = goal < 1 ? std::sqrt((1 - visibility) / (1 - goal)) : kInfinity;
  return std::clamp(std::max(1 + 10 * (goal - visibility), 1 + 0.25 * (share - 1)), 1.01, 1.3);
}

}  // namespace explica::unfolding
