// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/StopRule.h"

#include "Trend.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

constexpr double kLargestDrive = 8;   // lengths and contacts are outweighed up to here
constexpr double kUsualDrive = 4;     // ... weighed against lengths as stiff as by default
constexpr double kLeastDrive = 0.1;   // ... and the visibility term down to here
constexpr double kOpen = 0.9;         // visibility from which on seeing and lengths are weighed
constexpr double kBalanced = 0.0008;  // of visibility
constexpr double kEnough = 0.001;     // to spare of both: no iteration is spent on more
constexpr int kLookEvery = 5;         // iterations from one look to the next, ...
constexpr double kAppearing = 1e-3;   // ... in which so much more of the area has to be seen
constexpr int kBalancing = 142;       // iterations at most that seeing and lengths are weighed

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

/// Up to where lengths are outweighed: stiffer ones farther.
double largestDrive(const UnfoldOptions& options) {
  const double usual = kTerms[static_cast<std::size_t>(Term::Spring)].weight;
  const double stiffer = std::max(1.0, options.unfolder.weights[Term::Spring] / usual);
  return std::min(kUsualDrive * stiffer, kLargestDrive);
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

/// True if too little of the region is seen, but more from one look to the next.
bool StopRule::isStillAppearing(Unfolder& unfolder) {
  const Look before = unfolder.state().look;
  const bool looked = before.iteration >= 0;
  if (looked && unfolder.state().iteration - before.iteration < kLookEvery) {
    return before.seen < kGoalSeen;
  }
  const double seen = unfolder.look();
  return seen < kGoalSeen && (!looked || seen > before.seen + kAppearing);
}

/// Soft areas as long as what is seen is far from its goal, then stiff ones.
Termination StopRule::weigh(Unfolder& unfolder, const std::vector<IterationRecord>& history) const {
  const IterationRecord& last = history.back();
  const auto [factor, nearGoal] = steer(history);
  const double drive = unfolder.state().drive;
  const double most = largestDrive(options_);
  const bool atLimit = factor > 1 ? drive >= most : drive <= kLeastDrive;
  const bool balanced = std::abs(last.visibility - goalAt(last.edgeStrainMean)) < kBalanced;
  const bool atRest = isAtRest(history);
  const bool elastic = options_.unfolder.surround == Surround::Elastic;
  const bool torn = elastic && isTorn(history);
  const bool enough = merit(last.visibility, last.edgeStrainMean) > kEnough && !torn;
  const bool longEnough = last.iteration - unfolder.state().driveIteration > kBalancing;
  const bool ended = enough || longEnough || ((balanced || atLimit) && atRest);
  const bool kept = last.areaErrorMean <= options_.areaTolerance;
  const bool appearing = ended && kept && isStillAppearing(unfolder);
  if (ended && kept && (longEnough || !appearing)) return Termination::Converged;
  if (static_cast<int>(history.size()) > options_.maxIterations) return Termination::MaxIterations;
  unfolder.balance(std::clamp(drive * factor, kLeastDrive, most) / drive,
                   !kept && (nearGoal || (atLimit && !isGaining(history)) || atRest));
  return Termination::NotRun;
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
  if (!thesis && !options_.targetVisibility) unfolder.balance(1, false);  // areas are soft at first
  if (!thesis && started && unfolder.isHeldBelow()) {
    if (settled) unfolder.makeWay();
  } else if (thesis || options_.targetVisibility) {
    if (settled && (kept || thesis)) {
      if (!options_.targetVisibility) return Termination::Converged;
      if (thesis || unfolder.state().drive >= kLargestDrive) return Termination::Stalled;
      unfolder.raiseDrive(driveFactor(last.visibility, goal));
    }
  } else if (started && (settled || last.visibility > kOpen)) {
    const Termination end = weigh(unfolder, history);
    if (end != Termination::NotRun) return end;
  }
  return limit ? Termination::MaxIterations : Termination::NotRun;
}

}  // namespace explica::unfolding
