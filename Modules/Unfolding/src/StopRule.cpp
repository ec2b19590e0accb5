// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/StopRule.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

constexpr double kLargestDrive = 8;   // lengths and contacts are outweighed up to here
constexpr double kLeastDrive = 0.1;   // ... and the visibility term down to here
constexpr double kBalanced = 0.0008;  // of visibility
constexpr double kEnough = 0.002;     // of merit: no iteration is spent on more
constexpr int kBalancing = 150;       // iterations at most that seeing and lengths are weighed

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

/// True if folds no longer open fast, or lengths have so much to spare that no fold is in the way:
/// what is seen and lengths can then be weighed.
bool isOpen(const std::vector<IterationRecord>& history, int since) {
  constexpr std::size_t kWindow = 4;
  constexpr double kGain = 0.006;    // of visibility over the window ...
  constexpr double kHalfOpen = 0.9;  // ... where slowness is not that of a fold on its way
  constexpr double kMuch = 0.021;    // of visibility
  const IterationRecord& last = history.back();
  if (last.iteration - since < static_cast<int>(kWindow)) return false;
  if (last.visibility < kHalfOpen) return false;
  return lengthsToSpare(last.edgeStrainMean) > kMuch ||
         last.visibility - history[history.size() - 1 - kWindow].visibility < kGain;
}

/// What lengths have to spare more than what is seen, in visibility; nothing where the one that
/// gains has plenty.
double imbalance(double visibility, double strain) {
  const double seen = seenToSpare(visibility), lengths = lengthsToSpare(strain);
  return std::min(seen, lengths) < kPlenty ? lengths - seen : 0;
}

/// By how much the visibility term shall be stronger or weaker in the next step: where the last
/// ones lead to counts.
double balancingFactor(const std::vector<IterationRecord>& history) {
  constexpr double kLead = 4;      // steps that the last one is carried on for
  constexpr double kGain = 3;      // of the factor for each of visibility
  constexpr double kMost = 0.03;   // of the strength per step ...
  constexpr double kFaster = 1.5;  // ... and more for each of visibility that lengths ...
  constexpr double kFrom = 0.005;  // ... have to spare beyond this
  const IterationRecord& last = history.back();
  const IterationRecord& before = history[history.size() - 2];
  const double gap =
      imbalance(last.visibility + kLead * (last.visibility - before.visibility),
                last.edgeStrainMean + kLead * (last.edgeStrainMean - before.edgeStrainMean));
  const double most =
      1 + kMost + kFaster * std::max(0.0, lengthsToSpare(last.edgeStrainMean) - kFrom);
  return std::clamp(1 + kGain * gap, 1 / most, most);
}

/// True if the last steps changed neither what is seen nor lengths by anything that counts.
bool isAtRest(const std::vector<IterationRecord>& history) {
  constexpr std::size_t kWindow = 5;
  constexpr double kMove = 3e-4;
  if (history.size() <= kWindow) return false;
  const IterationRecord& last = history.back();
  const IterationRecord& before = history[history.size() - 1 - kWindow];
  return std::abs(last.visibility - before.visibility) < kMove &&
         std::abs(last.edgeStrainMean - before.edgeStrainMean) < kMove;
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
  const IterationRecord& last = history.back();
  const bool thesis = options_.unfolder.method == Method::Thesis;
  const double goal = options_.targetVisibility.value_or(1.0);
  const bool atGoal = options_.targetVisibility && last.visibility >= goal;
  const bool kept = last.areaErrorMean <= options_.areaTolerance;
  if (atGoal && targetHolds(history)) return Termination::TargetReached;
  const bool started = thesis || !unfolder.state().separating;
  const int since = unfolder.state().driveIteration;
  const bool settled = !atGoal && started && isSettled(history, since);
  const bool limit = static_cast<int>(history.size()) > options_.maxIterations;
  if (!thesis && started && unfolder.isHeldBelow()) {
    if (settled) unfolder.makeWay();
  } else if (thesis || options_.targetVisibility) {
    if (settled && (kept || thesis)) {
      if (!options_.targetVisibility) return Termination::Converged;
      if (thesis || unfolder.state().drive >= kLargestDrive) return Termination::Stalled;
      unfolder.raiseDrive(driveFactor(last.visibility, goal));
    }
  } else if (started && (settled || isOpen(history, since))) {
    const double factor = balancingFactor(history);
    const double drive = unfolder.state().drive;
    const bool atLimit = factor > 1 ? drive >= kLargestDrive : drive <= kLeastDrive;
    const bool balanced = std::abs(imbalance(last.visibility, last.edgeStrainMean)) < kBalanced;
    const bool longEnough = last.iteration - since > kBalancing;
    const bool enough = merit(last.visibility, last.edgeStrainMean) > kEnough;
    if (kept && (enough || longEnough || ((balanced || atLimit) && isAtRest(history)))) {
      return Termination::Converged;
    }
    if (limit) return Termination::MaxIterations;
    if (!enough) {
      unfolder.balance(std::clamp(drive * factor, kLeastDrive, kLargestDrive) / drive);
    }
  }
  return limit ? Termination::MaxIterations : Termination::NotRun;
}

}  // namespace explica::unfolding
