// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Continuation.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

constexpr int kWindow = 10;              // iterations in which a run at rest hardly changes
constexpr double kSunk = 0.01;           // of the region's area: less than that below is no reason
constexpr double kNear = 2 * kAccuracy;  // of the visibility's aim
constexpr double kMostSteering = 1.15;   // factor of the visibility term a step

void requireUsable(const UnfoldOptions& options) {
  if (options.targetVisibility &&
      !(*options.targetVisibility > 0 && *options.targetVisibility <= 1)) {
    throw InvalidInput("target-visibility: must be above 0 and at most 1");
  }
  if (!(options.areaTolerance > 0)) throw InvalidInput("area-tolerance: must be positive");
  if (!(options.trade > 0)) throw InvalidInput("trade: must be positive");
  if (options.maxIterations <= 0) throw InvalidInput("max-iterations: must be positive");
  if (options.maxTime && !(*options.maxTime > 0)) throw InvalidInput("max-time: must be positive");
  if (options.frames < 0) throw InvalidInput("frames: must not be negative");
}

/// Where a quantity leads to whose steps shrink as the last two did [Aitken], by a quarter at
/// least.
double limitOf(const std::vector<IterationRecord>& history, double IterationRecord::*quantity) {
  constexpr double kSlowest = 0.75;
  const auto back = [&](std::size_t n) { return history[history.size() - 1 - n].*quantity; };
  if (history.size() < 3) return back(0);
  const double step = back(0) - back(1), before = back(1) - back(2);
  const double ratio = before == 0 ? 0 : std::clamp(step / before, 0.0, kSlowest);
  return back(0) + ratio / (1 - ratio) * step;
}

/// The most that visibility, or strain by what it is worth, has changed over the window; by how
/// much the visibility has risen where nothing else is sought (the thesis's flow); infinity of runs
/// that are not as long, or where too little of the region is seen but more and more.
double changeOver(const std::vector<IterationRecord>& history, const UnfoldOptions& options) {
  if (history.size() <= kWindow) return kInfinity;
  const IterationRecord& last = history.back();
  const IterationRecord& then = history[history.size() - 1 - kWindow];
  const double rise = last.visibility - then.visibility;
  if (options.unfolder.method == Method::Thesis) return rise;
  if (last.seen < kGoalSeen && !(last.seen - then.seen < kAccuracy / 2)) return kInfinity;
  return std::max(std::abs(rise),
                  std::abs(last.edgeStrainMean - then.edgeStrainMean) / options.trade);
}

/// Strength of the visibility term at which one per cent of visibility costs the strain that it is
/// worth: trade times the slope, by strain, of what lengths cost at their goal.
double largestDrive(const UnfoldOptions& options) {
  const double share = kGoalStrain / options.unfolder.yieldStrain;
  const double slope = 2 * kGoalStrain / std::sqrt(1 + share * share);
  return options.trade * options.unfolder.weights[Term::Spring] * slope;
}

}  // namespace

double aimAt(const UnfoldOptions& options, double strain) {
  if (options.targetVisibility) return *options.targetVisibility + kAccuracy;
  return kGoalVisibility + std::min(3 * kAccuracy, (kGoalStrain - strain) / options.trade);
}

double steering(double visibility, double aim) {
  if (!(aim < 1)) return kMostSteering;
  return std::clamp(std::sqrt(std::max(0.0, 1 - visibility) / (1 - aim)), 1 / kMostSteering,
                    kMostSteering);
}

Continuation::Continuation(const UnfoldOptions& options) : options_(options) {
  requireUsable(options);
}

/// Where a run is and where it leads.
struct Continuation::Outlook {
  double aim = 1;             ///< visibility to aim at
  double visibility = kNaN;   ///< that the run is bound for
  double change = kInfinity;  ///< over the window, of visibility or what strain is worth
  bool rests = false;         ///< nothing changes, and the visibility term's strength is at its end
  bool kept = false;          ///< areas are
  bool rises = false;         ///< the region, which is below its surroundings
};

Continuation::Outlook Continuation::outlook(const Unfolder& unfolder,
                                            const std::vector<IterationRecord>& history) const {
  Outlook now;
  now.aim = aimAt(options_, limitOf(history, &IterationRecord::edgeStrainMean));
  now.visibility = limitOf(history, &IterationRecord::visibility);
  now.change = changeOver(history, options_);
  const bool strongest = unfolder.state().drive >= largestDrive(options_);
  now.rests = now.change < kAccuracy / 2 && (strongest || now.visibility > now.aim - kNear);
  now.kept = history.back().areaErrorMean <= options_.areaTolerance;
  now.rises = now.change > kNear && unfolder.sunkShare() > kSunk;
  return now;
}

Termination Continuation::endOf(const Outlook& now, const IterationRecord& last) const {
  const auto& target = options_.targetVisibility;
  const bool reached = target && last.visibility >= *target;
  if (options_.unfolder.method == Method::Thesis) {
    if (reached) return Termination::TargetReached;
    if (now.change >= kAccuracy / 2) return Termination::NotRun;
    return target ? Termination::Stalled : Termination::Converged;
  }
  const bool enough = !target && merit(last, options_) > kAccuracy;
  if (now.rises || !now.kept || !(enough || now.rests)) return Termination::NotRun;
  if (target && !reached) return Termination::Stalled;
  return target ? Termination::TargetReached : Termination::Converged;
}

void Continuation::steer(Unfolder& unfolder, const Outlook& now) const {
  if (options_.unfolder.method == Method::Thesis) return;
  const double drive = unfolder.state().drive, most = std::max(drive, largestDrive(options_));
  if (now.rises) return unfolder.steer(drive, Phase::Opening);
  const bool slow = now.rests || (drive >= most && now.change < 3 * kAccuracy);
  const bool settles = !now.kept && (slow || now.visibility > now.aim - kNear);
  unfolder.steer(std::min(most, drive * steering(now.visibility, now.aim)),
                 settles ? Phase::Settling : Phase::Weighing);
}

Termination Continuation::next(Unfolder& unfolder,
                               const std::vector<IterationRecord>& history) const {
  const Outlook now = outlook(unfolder, history);
  const Termination end = endOf(now, history.back());
  if (end != Termination::NotRun) return end;
  if (static_cast<int>(history.size()) > options_.maxIterations) return Termination::MaxIterations;
  steer(unfolder, now);
  return Termination::NotRun;
}

}  // namespace explica::unfolding
