// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/StopRule.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

constexpr double kLargestDrive = 8;     // lengths and contacts are outweighed up to here
constexpr double kLeastDrive = 0.1;     // ... and the visibility term down to here
constexpr double kMostSteering = 1.15;  // factor of the visibility term a step
constexpr double kOpen = 0.9;           // visibility from which on seeing and lengths are weighed
constexpr double kBalanced = 0.0008;    // of visibility
constexpr double kAim = 0.003;          // to spare of visibility, what tightening areas may cost
constexpr double kEnough = 0.001;       // to spare of both: no iteration is spent on more
constexpr int kBalancing = 150;         // iterations at most that seeing and lengths are weighed

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

/// Where a quantity leads to whose steps shrink as the last two did [Aitken], by a quarter at
/// least.
double limitOf(const std::vector<IterationRecord>& history, double IterationRecord::*quantity) {
  constexpr double kSlowest = 0.75;
  const auto back = [&](std::size_t n) { return history[history.size() - 1 - n].*quantity; };
  const double step = back(0) - back(1), before = back(1) - back(2);
  const double ratio = before == 0 ? 0 : std::clamp(step / before, 0.0, kSlowest);
  return back(0) + ratio / (1 - ratio) * step;
}

/// Visibility to aim at: more than asked for, as long as lengths have as much to spare; less than
/// that where both lack.
double goalAt(double strain) {
  return kSeen + std::min(kAim, lengthsToSpare(strain));
}

/// How the next step shall differ from the last.
struct Steering {
  double factor = 1;     ///< of the visibility term
  bool nearGoal = true;  ///< what is seen comes to its goal without it
};

/// Against springs the deficit 1 - v falls about with the square of the visibility term.
Steering steer(const std::vector<IterationRecord>& history) {
  constexpr double kNear = 0.002;  // of visibility
  if (history.size() < 3) return {};
  const double visibility = std::min(1.0, limitOf(history, &IterationRecord::visibility));
  const double goal = goalAt(limitOf(history, &IterationRecord::edgeStrainMean));
  const double factor = std::sqrt((1 - visibility) / (1 - goal));
  return {std::clamp(factor, 1 / kMostSteering, kMostSteering), visibility > goal - kNear};
}

/// True if the last steps changed neither what is seen nor lengths by anything that counts.
bool isAtRest(const std::vector<IterationRecord>& history) {
  constexpr std::size_t kWindow = 5;
  constexpr double kMove = 1e-4;
  if (history.size() <= kWindow) return false;
  const IterationRecord& last = history.back();
  const IterationRecord& before = history[history.size() - 1 - kWindow];
  return std::abs(last.visibility - before.visibility) < kMove &&
         std::abs(last.edgeStrainMean - before.edgeStrainMean) < kMove;
}

/// True if a face of the collar is stretched beyond what it should be and is still giving way back:
/// one that is caught in a contact stays as it is, and is no reason to go on.
bool isTorn(const std::vector<IterationRecord>& history) {
  constexpr std::size_t kWindow = 5;
  const double now = history.back().collarStretchMax;
  if (history.size() <= kWindow) return now > kCollarMost;
  return now > kCollarMost && now < history[history.size() - 1 - kWindow].collarStretchMax;
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

/// Soft areas as long as what is seen is far from its goal, then stiff ones.
Termination StopRule::weigh(Unfolder& unfolder, const std::vector<IterationRecord>& history) const {
  const IterationRecord& last = history.back();
  const auto [factor, nearGoal] = steer(history);
  const double drive = unfolder.state().drive;
  const bool atLimit = factor > 1 ? drive >= kLargestDrive : drive <= kLeastDrive;
  const bool balanced = std::abs(last.visibility - goalAt(last.edgeStrainMean)) < kBalanced;
  const bool atRest = isAtRest(history);
  const bool elastic = options_.unfolder.surround == Surround::Elastic;
  const bool torn = elastic && isTorn(history);
  const bool enough = merit(last.visibility, last.edgeStrainMean) > kEnough && !torn;
  const bool longEnough = last.iteration - unfolder.state().driveIteration > kBalancing;
  const bool ended = enough || longEnough || ((balanced || atLimit) && atRest);
  const bool kept = last.areaErrorMean <= options_.areaTolerance;
  if (ended && kept) return Termination::Converged;
  if (static_cast<int>(history.size()) > options_.maxIterations) return Termination::MaxIterations;
  unfolder.balance(std::clamp(drive * factor, kLeastDrive, kLargestDrive) / drive,
                   !kept && (nearGoal || atLimit || atRest));
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
