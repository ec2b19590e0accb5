// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Unfold.h"

#include "Explica/Core/Errors.h"
#include "Explica/Visibility/AverageVisibility.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

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

/// States on the path whose visibilities are evenly spaced, first and last included.
std::vector<UnfoldFrame> framesAlong(const Unfolder& unfolder,
                                     const visibility::Viewpoints& viewpoints,
                                     const std::vector<Positions>& path, int count) {
  std::vector<UnfoldFrame> frames;
  if (count <= 0 || path.empty()) return frames;
  const visibility::AverageVisibility measure(unfolder.reference().faces, unfolder.region().faces,
                                              viewpoints);
  const auto stateAt = [&](std::size_t n, double t) {
    UnfoldFrame frame;
    frame.positions = unfolder.reference().positions;
    const auto& moving = unfolder.movingVertices();
    for (std::size_t i = 0; i < moving.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      frame.positions.row(moving[i]) =
          t == 0 ? Eigen::RowVector3d(path[n].row(row))
                 : Eigen::RowVector3d(path[n].row(row) +
                                      t * (path[n + 1].row(row) - path[n].row(row)));
    }
    frame.visibility = measure.value(frame.positions);
    return frame;
  };
  const UnfoldFrame first = stateAt(0, 0), last = stateAt(path.size() - 1, 0);
  if (count == 1) return {last};
  frames.push_back(first);
  std::size_t n = 0;
  UnfoldFrame next = path.size() > 1 ? stateAt(1, 0) : last;
  for (int k = 1; k + 1 < count; ++k) {
    const double wanted = first.visibility + (last.visibility - first.visibility) * k / (count - 1);
    while (n + 2 < path.size() && next.visibility < wanted) next = stateAt(++n + 1, 0);
    if (n + 1 >= path.size()) break;
    double low = 0, high = 1;
    UnfoldFrame frame;
    for (int halving = 0; halving < 20; ++halving) {
      const double middle = 0.5 * (low + high);
      frame = stateAt(n, middle);
      if (std::abs(frame.visibility - wanted) < 1e-5) break;
      (frame.visibility < wanted ? low : high) = middle;
    }
    frames.push_back(std::move(frame));
  }
  frames.push_back(last);
  return frames;
}

}  // namespace

UnfoldResult unfold(const TriangleMesh& mesh, const Region& region,
                    const visibility::Viewpoints& viewpoints, const UnfoldOptions& options,
                    const Monitor& monitor, const Checkpoint* resume) {
  requireUsable(options);
  const auto begin = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  Unfolder unfolder(mesh, region, viewpoints, options.unfolder);
  UnfoldResult result;
  const double initial = unfolder.record().visibility;
  if (!(initial > 0)) {
    throw InvalidInput("region: its average visibility is " + std::to_string(initial) +
                       ", but only a positive one can be unfolded; look from another side, or let "
                       "the region be adjusted (--adjust-region)");
  }
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
  const bool thesis = options.unfolder.method == Method::Thesis;
  int sinceGoal = 0;
  for (const IterationRecord& row : result.history) sinceGoal += row.visibility >= goal;
  for (result.termination = Termination::NotRun; result.termination == Termination::NotRun;) {
    const IterationRecord& last = result.history.back();
    constexpr int kPolish = 100;  // iterations for the areas once the visibility is reached
    const bool kept = last.areaErrorMean <= options.areaTolerance;
    if (options.targetVisibility && last.visibility >= goal &&
        ((kept && (thesis || isRelaxed(result.history))) || sinceGoal > kPolish)) {
      if (!kept) {
        monitor.warn("the visibility is reached, but the mean area error stays at " +
                     std::to_string(last.areaErrorMean));
      }
      result.termination = Termination::TargetReached;
    } else if (!(options.targetVisibility && last.visibility >= goal) && (kept || thesis) &&
               isSettled(result.history, unfolder.state().driveIteration)) {
      // Lengths and contacts balance the visibility: outweigh them as far as the target needs it.
      constexpr double kLargestDrive = 4;
      if (!options.targetVisibility) {
        result.termination = Termination::Converged;
      } else if (!thesis && unfolder.state().drive < kLargestDrive) {
        unfolder.raiseDrive(driveFactor(last.visibility, goal));
      } else {
        result.termination = Termination::Stalled;
      }
    } else if (static_cast<int>(result.history.size()) > options.maxIterations) {
      result.termination = Termination::MaxIterations;
    } else if (monitor.shouldStop()) {
      result.termination = Termination::Interrupted;
    } else if (options.maxTime && elapsed() >= *options.maxTime) {
      result.termination = Termination::MaxTime;
    } else if (!unfolder.step()) {
      result.termination = Termination::Stalled;
    } else {
      result.history.push_back(unfolder.record());
      result.history.back().seconds = earlier + elapsed();
      sinceGoal += unfolder.record().visibility >= goal;
      if (options.frames > 0) path.push_back(movingOnly(unfolder));
      char line[96];
      std::snprintf(line, sizeof line, "iteration %d: visibility %.4f, area error %.2f %%",
                    unfolder.record().iteration, unfolder.record().visibility,
                    100 * unfolder.record().areaErrorMean);
      monitor.progress(
          std::clamp((unfolder.record().visibility - initial) / (goal - initial), 0.0, 1.0), line);
    }
  }
  const bool byItself =
      result.termination == Termination::Converged || result.termination == Termination::Stalled;
  if (byItself && !thesis && options.unfolder.surround == Surround::Fixed) {
    warnIfHeld(result.history.back().visibility, monitor);
  }
  result.frames = framesAlong(unfolder, viewpoints, path, options.frames);
  result.mesh = unfolder.current();
  result.region = unfolder.region();
  result.checkpoint = {unfolder.state(), result.history, std::move(path)};
  return result;
}

}  // namespace explica::unfolding
