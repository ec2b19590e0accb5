// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Continuation.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace explica::unfolding {
namespace {

constexpr int kWindow = 10;  // iterations in which a run at rest changes by half of kAccuracy
constexpr double kMostSteering = 1.15;  // factor of the visibility term a step

void requireUsable(const UnfoldOptions& options) {
  if (options.targetVisibility &&
      !(*options.targetVisibility > 0 && *options.targetVisibility <= 1)) {
    throw InvalidInput("target-visibility: must be above 0 and at most 1");
  }
  if (!(options.trade > 0)) throw InvalidInput("trade: must be positive");
  if (options.maxIterations <= 0) throw InvalidInput("max-iterations: must be positive");
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
/// much the visibility has risen where nothing else is sought (the thesis's flow); infinity if it
/// is not that long ago that the run was changed from outside.
double changeOver(const std::vector<IterationRecord>& history, int since,
                  const UnfoldOptions& options) {
  const IterationRecord& last = history.back();
  if (last.iteration - since < kWindow || history.size() <= kWindow) return kInfinity;
  const IterationRecord& then = history[history.size() - 1 - kWindow];
  const double rise = last.visibility - then.visibility;
  if (options.unfolder.method == Method::Thesis) return rise;
  return std::max(std::abs(rise),
                  std::abs(last.edgeStrainMean - then.edgeStrainMean) / options.trade);
}

/// Whether areas, as stiff as they get, come no nearer to being kept: they changed as little over
/// the window as what is at rest, and as many iterations more would not keep them.
bool areasAreHeld(const std::vector<IterationRecord>& history, double tolerance) {
  const auto window = std::span(history).last(kWindow + 1);
  for (const IterationRecord& record : window.subspan(1)) {
    if (record.phase != Phase::Settling) return false;
  }
  const double error = window.back().areaErrorShare;
  return window.front().areaErrorShare - error < std::min(kAccuracy / 2, error - tolerance);
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
  const IterationRecord& last;
  double change = kInfinity;  ///< over the window, of visibility or what strain is worth
  double visibility = kNaN;   ///< that the run is bound for, or the share seen if that is less
  double seen = kNaN;         ///< share of the region's area; only asked where enough is visible
  double aim = 1;             ///< visibility to aim at
  bool appears = false;       ///< more is seen than a step before
  bool strongest = false;     ///< the visibility term is at its end
  /// Whether steering could still change anything.
  [[nodiscard]] bool isWeighed() const { return strongest || visibility > aim - 2 * kAccuracy; }
  [[nodiscard]] bool rests() const { return change < kAccuracy / 2 && !appears; }
};

Continuation::Outlook Continuation::outlook(Unfolder& unfolder,
                                            const std::vector<IterationRecord>& history) const {
  Outlook now{history.back()};
  now.change = changeOver(history, unfolder.state().driveIteration, options_);
  now.visibility = limitOf(history, &IterationRecord::visibility);
  now.aim = aimAt(options_, limitOf(history, &IterationRecord::edgeStrainMean));
  now.strongest = unfolder.state().drive >= (1 - 1e-9) * largestDrive(options_);
  const bool asks = options_.unfolder.method == Method::Implicit && !options_.targetVisibility;
  if (asks && now.visibility > now.aim - 2 * kAccuracy) {
    now.seen = unfolder.look();
    now.appears = unfolder.state().look.rise > kAccuracy / 2;
    now.visibility = std::min(now.visibility, now.seen);
  }
  return now;
}

Termination Continuation::endOf(Unfolder& unfolder, const std::vector<IterationRecord>& history,
                                const Outlook& now) const {
  const auto& target = options_.targetVisibility;
  const IterationRecord& last = now.last;
  const bool reached = target && last.visibility >= *target;
  if (options_.unfolder.method == Method::Thesis) {
    if (reached) return Termination::TargetReached;
    if (!now.rests()) return Termination::NotRun;
    return target ? Termination::Stalled : Termination::Converged;
  }
  if (unfolder.isHeldBelow()) return Termination::NotRun;
  const bool gives =
      options_.unfolder.surround == Surround::Elastic && last.collarStretchMax > kCollarMost;
  const bool enough =
      !target && !gives &&
      merit(last.visibility, last.edgeStrainMean, now.seen, options_.trade) > kAccuracy;
  if (!enough && !(now.rests() && now.isWeighed())) return Termination::NotRun;
  const bool kept = last.areaErrorShare <= options_.areaTolerance;
  if (!kept && (enough || reached || !areasAreHeld(history, options_.areaTolerance))) {
    return Termination::NotRun;
  }
  if (target) return reached ? Termination::TargetReached : Termination::Stalled;
  return Termination::Converged;
}

void Continuation::steer(Unfolder& unfolder, const Outlook& now) const {
  unfolder.steer(Phase::Opening, 1);
  if (options_.unfolder.method == Method::Thesis) return;
  if (unfolder.isHeldBelow()) {
    if (now.change < 2 * kAccuracy) unfolder.makeWay();  // it hardly opens any more
    return;
  }
  const double drive = unfolder.state().drive, most = std::max(drive, largestDrive(options_));
  const bool slow = now.rests() || (drive >= most && now.change < 3 * kAccuracy);
  const bool kept = now.last.areaErrorShare <= options_.areaTolerance;
  const bool settles = !kept && (slow || now.visibility > now.aim - 2 * kAccuracy);
  unfolder.steer(settles ? Phase::Settling : Phase::Weighing,
                 std::min(most, drive * steering(now.visibility, now.aim)) / drive);
}

Termination Continuation::next(Unfolder& unfolder,
                               const std::vector<IterationRecord>& history) const {
  const Outlook now = outlook(unfolder, history);
  const Termination end = endOf(unfolder, history, now);
  if (end != Termination::NotRun) return end;
  if (static_cast<int>(history.size()) > options_.maxIterations) return Termination::MaxIterations;
  steer(unfolder, now);
  return Termination::NotRun;
}

}  // namespace explica::unfolding
