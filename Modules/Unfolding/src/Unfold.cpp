// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Unfold.h"

#include "Frames.h"

#include "Explica/Core/Errors.h"
#include "Explica/Unfolding/StopRule.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace explica::unfolding {
namespace {

/// A single ring of straight faces joins the region to fixed surroundings; it cannot bend about the
/// walls that it stands between, and holds the rim.
void warnIfHeld(double visibility, const Monitor& monitor) {
  constexpr double kHeld = 0.95;  // regions with room reach more
  if (visibility >= kHeld) return;
  char text[160];
  std::snprintf(text, sizeof text,
                "fixed surroundings hold the region at a visibility of %.3f; with --surround "
                "elastic a collar follows, and it opens further",
                visibility);
  monitor.warn(text);
}

Positions movingOnly(const Unfolder& unfolder) {
  const auto& moving = unfolder.movingVertices();
  Positions rows(static_cast<Eigen::Index>(moving.size()), 3);
  for (std::size_t i = 0; i < moving.size(); ++i) {
    rows.row(static_cast<Eigen::Index>(i)) = unfolder.state().positions.row(moving[i]);
  }
  return rows;
}

void requirePositive(double visibility) {
  if (visibility > 0) return;
  throw InvalidInput("region: its average visibility is " + std::to_string(visibility) +
                     ", but only a positive one can be unfolded; look from another side, or let "
                     "the region be adjusted (--adjust-region)");
}

void tellProgress(const Monitor& monitor, const IterationRecord& now, double initial, double goal) {
  char line[96];
  std::snprintf(line, sizeof line, "iteration %d: visibility %.4f, area error %.2f %%",
                now.iteration, now.visibility, 100 * now.areaErrorMean);
  monitor.progress(std::clamp((now.visibility - initial) / (goal - initial), 0.0, 1.0), line);
}

void warnOfShortcomings(const UnfoldResult& result, const UnfoldOptions& options,
                        const Monitor& monitor) {
  const IterationRecord& last = result.history.back();
  if (result.termination == Termination::TargetReached &&
      last.areaErrorMean > options.areaTolerance) {
    monitor.warn("the visibility is reached, but the mean area error stays at " +
                 std::to_string(last.areaErrorMean));
  }
  const bool byItself =
      result.termination == Termination::Converged || result.termination == Termination::Stalled;
  if (byItself && options.unfolder.method == Method::Implicit &&
      options.unfolder.surround == Surround::Fixed) {
    warnIfHeld(last.visibility, monitor);
  }
}

}  // namespace

UnfoldResult unfold(const TriangleMesh& mesh, const Region& region,
                    const visibility::Viewpoints& viewpoints, const UnfoldOptions& options,
                    const Monitor& monitor, const Checkpoint* resume) {
  const StopRule rule(options);
  const auto begin = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  Unfolder unfolder(mesh, region, viewpoints, options.unfolder);
  UnfoldResult result;
  const double initial = unfolder.record().visibility;
  requirePositive(initial);
  std::vector<Positions> path;
  if (resume != nullptr) {
    unfolder.restore(resume->state);
    result.history = resume->history;
    path = resume->path;
  } else {
    result.history.push_back(unfolder.record());
  }
  if (options.frames > 0 && path.empty()) path.push_back(movingOnly(unfolder));

  const double earlier = result.history.back().seconds;
  const double goal = options.targetVisibility.value_or(1.0);
  const auto reason = [&] {
    const Termination byItself = rule.check(unfolder, result.history);
    if (byItself != Termination::NotRun) return byItself;
    if (monitor.shouldStop()) return Termination::Interrupted;
    if (options.maxTime && elapsed() >= *options.maxTime) return Termination::MaxTime;
    return unfolder.step() ? Termination::NotRun : Termination::Stalled;
  };
  while ((result.termination = reason()) == Termination::NotRun) {
    result.history.push_back(unfolder.record());
    result.history.back().seconds = earlier + elapsed();
    if (options.frames > 0) path.push_back(movingOnly(unfolder));
    tellProgress(monitor, unfolder.record(), initial, goal);
  }
  warnOfShortcomings(result, options, monitor);
  result.frames = framesAlong(unfolder, viewpoints, path, options.frames);
  result.mesh = unfolder.current();
  result.region = unfolder.region();
  result.checkpoint = {unfolder.state(), result.history, std::move(path)};
  return result;
}

}  // namespace explica::unfolding
