// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/StopRule.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

void requireUsable(const UnfoldOptions& options) {
  if (options.targetVisibility &&
      !(*options.targetVisibility > 0 && *options.targetVisibility <= 1)) {
    throw InvalidInput("target-visibility: must be above 0 and at most 1");
  }
  if (!(options.areaTolerance > 0)) throw InvalidInput("area-tolerance: must be positive");
  if (options.maxIterations <= 0) throw InvalidInput("max-iterations: must be positive");
  if (options.maxTime && !(*options.maxTime > 0)) throw InvalidInput("max-time: must be positive");
  if (options.frames < 0) throw InvalidInput("frames: must not be negative");
}

/// True if the last iterations brought the visibility no further and the areas are kept.
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

/// True if lengths no longer recover: the strain fell by less than 0.4 % over the last steps.
bool isRelaxed(const std::vector<IterationRecord>& history) {
  constexpr std::size_t kWindow = 5;
  if (history.size() <= kWindow) return false;
  const double before = history[history.size() - 1 - kWindow].edgeStrainMean;
  return history.back().edgeStrainMean > 0.996 * before;
}

/// How much stronger the visibility term has to be for a goal.  Against springs the deficit 1 - v
/// falls with its square: a quarter of the way at a time, since lengths are better spared.
double driveFactor(double visibility, double goal) {
  const double share = goal < 1 ? std::sqrt((1 - visibility) / (1 - goal)) : kInfinity;
  return std::clamp(std::max(1 + 10 * (goal - visibility), 1 + 0.25 * (share - 1)), 1.01, 1.3);
}

}  // namespace

StopRule::StopRule(const UnfoldOptions& options) : options_(options) {
  requireUsable(options);
}

bool StopRule::targetHolds(const std::vector<IterationRecord>& history) const {
  constexpr int kPolish = 100;  // iterations for the areas once the visibility is reached
  const double goal = *options_.targetVisibility;
  if (history.back().visibility < goal) return false;
  const auto atGoal = std::count_if(history.begin(), history.end(),
                                    [goal](const auto& row) { return row.visibility >= goal; });
  const bool settled = history.back().areaErrorMean <= options_.areaTolerance &&
                       (options_.unfolder.method == Method::Thesis || isRelaxed(history));
  return settled || atGoal > kPolish;
}

Termination StopRule::check(Unfolder& unfolder, const std::vector<IterationRecord>& history) const {
  constexpr double kLargestDrive = 4;  // lengths and contacts are outweighed up to here
  constexpr double kFirming = 1.03;  // of the lengths' strength per iteration, where enough is seen
  constexpr double kFirmest = 2;     // ... up to here
  const IterationRecord& last = history.back();
  const bool thesis = options_.unfolder.method == Method::Thesis;
  const double goal = options_.targetVisibility.value_or(1.0);
  const bool atGoal = options_.targetVisibility && last.visibility >= goal;
  const bool kept = last.areaErrorMean <= options_.areaTolerance;
  if (atGoal && targetHolds(history)) return Termination::TargetReached;
  const bool started = thesis || !unfolder.state().separating;
  const bool settled = !atGoal && started && isSettled(history, unfolder.state().driveIteration);
  const double firmness = unfolder.state().firmness;
  if (settled && !thesis && unfolder.isHeldBelow()) {
    unfolder.makeWay();
  } else if (settled && !thesis && !options_.targetVisibility && firmness < kFirmest &&
             last.visibility > kEnoughSeen && last.edgeStrainMean > kLittleStrained) {
    unfolder.firmUp(kFirming);
  } else if (settled && kept && !thesis && !options_.targetVisibility &&
             last.visibility < kSeenAsPromised && last.edgeStrainMean < kBearablyStrained &&
             unfolder.state().drive < kLargestDrive) {
    // Lengths have something to give where less is seen than promised.
    unfolder.raiseDrive(driveFactor(last.visibility, kEnoughSeen));
  } else if (settled && (kept || thesis)) {
    if (!options_.targetVisibility) return Termination::Converged;
    if (thesis || unfolder.state().drive >= kLargestDrive) return Termination::Stalled;
    unfolder.raiseDrive(driveFactor(last.visibility, goal));
  }
  const bool limit = static_cast<int>(history.size()) > options_.maxIterations;
  return limit ? Termination::MaxIterations : Termination::NotRun;
}

}  // namespace explica::unfolding
