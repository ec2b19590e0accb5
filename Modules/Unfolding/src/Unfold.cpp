// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Unfolding/Unfold.h"

#include "Frames.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Core/Stopwatch.h"
#include "Explica/Core/Text.h"
#include "Explica/Unfolding/Continuation.h"
#include "Explica/Visibility/VisibleFraction.h"

#include <algorithm>
#include <cmath>

namespace explica::unfolding {
namespace {

Positions movingOnly(const Unfolder& unfolder) {
  return unfolder.state().positions(unfolder.movingVertices(), Eigen::all);
}

/// The same state once more vertices move than did then: those stood where they stand at rest.
void addStanding(const Unfolder& unfolder, const std::vector<std::int32_t>& movedThen,
                 Positions& state) {
  Positions all = unfolder.reference().positions;
  all(movedThen, Eigen::all) = state;
  state = all(unfolder.movingVertices(), Eigen::all);
}

void requirePositive(double visibility) {
  if (visibility > 0) return;
  throw InvalidInput("region: its average visibility is " + std::to_string(visibility) +
                     ", but only a positive one can be unfolded; look from another side, or choose "
                     "another radius");
}

void tellProgress(const Monitor& monitor, const IterationRecord& now, double initial, double goal) {
  monitor.progress(std::clamp((now.visibility - initial) / (goal - initial), 0.0, 1.0),
                   printed("iteration %d: visibility %.4f, area error %.2f %%", now.iteration,
                           now.visibility, 100 * now.areaErrorMean));
}

/// Whether it pays to go back from a state.
bool isWorse(const IterationRecord& state, const BestState& than, const UnfoldOptions& options,
             double seen) {
  if (options.targetVisibility) return state.visibility < than.visibility - kAccuracy;
  return merit(state.visibility, state.edgeStrainMean, seen, options.trade) <
         merit(than.visibility, than.strain, than.seen, options.trade) - kAccuracy;
}

/// Share of the region that is seen in the present state, if anybody has begun to ask.
double seenIfAsked(Unfolder& unfolder) {
  return unfolder.state().look.iteration < 0 ? kNaN : unfolder.look();
}

/// Takes note of a state if it keeps areas and is better than all before.
void consider(Unfolder& unfolder, const UnfoldOptions& options, BestState& best) {
  const IterationRecord& now = unfolder.record();
  if (now.areaErrorShare > options.areaTolerance) return;
  const double seen = seenIfAsked(unfolder);
  if (!isBetter(now, best, options.targetVisibility.has_value(), seen, options.trade)) return;
  best = {now.iteration, now.visibility, now.edgeStrainMean, movingOnly(unfolder), seen};
}

/// Where the first look shows too little, its state is the best so far: nobody knows what was seen
/// of earlier ones.
void considerLook(const Unfolder& unfolder, bool isFirst, BestState& best) {
  const IterationRecord& now = unfolder.record();
  const Look& look = unfolder.state().look;
  if (!isFirst || look.iteration != now.iteration || look.seen >= kGoalSeen) return;
  best = {now.iteration, now.visibility, now.edgeStrainMean, movingOnly(unfolder), look.seen};
}

/// The state to give back: the last, or the best seen if the last is worse.
/// @return the share seen of its region's area
double chooseState(Unfolder& unfolder, const visibility::Viewpoints& viewpoints,
                   const BestState& best, const UnfoldOptions& options, UnfoldResult& result) {
  result.mesh = unfolder.current();
  result.iteration = unfolder.state().iteration;
  const double seen = unfolder.seenShare();
  if (!isWorse(unfolder.record(), best, options, seenIfAsked(unfolder))) return seen;
  result.mesh.positions(unfolder.movingVertices(), Eigen::all) = best.moving;
  result.iteration = best.iteration;
  return visibility::seenShare(result.mesh, unfolder.region().faces, viewpoints);
}

/// The visibility that counts as reached.
double goalOf(const UnfoldOptions& options) {
  return std::min(kGoalVisibility, options.targetVisibility.value_or(1.0));
}

/// Says which goals are missed, and by how much.
void sayWhatIsShort(const UnfoldOptions& options, const IterationRecord& kept, double seen,
                    const Monitor& monitor) {
  const double goal = goalOf(options);
  if (kept.visibility < goal) {
    monitor.warn(
        printed("the visibility is %.4f, %.4f short of its goal of %g%s", kept.visibility,
                goal - kept.visibility, goal,
                options.unfolder.surround == Surround::Fixed
                    ? ": fixed surroundings leave the region no room; with --surround elastic the "
                      "surrounding surface stretches with it, and it opens further"
                    : ""));
  }
  const double toSee = std::min(goal, kGoalSeen);
  if (seen < toSee) {
    monitor.warn(
        printed("%.4f of the region's area can be seen from the viewpoint, %.4f short of its goal "
                "of %g",
                seen, toSee - seen, toSee));
  }
  if (kept.edgeStrainMean > kGoalStrain) {
    monitor.warn(printed(
        "edges are strained by %.2f %% in the mean, %.2f %% beyond their goal of %g %%",
        100 * kept.edgeStrainMean, 100 * (kept.edgeStrainMean - kGoalStrain), 100 * kGoalStrain));
  }
  if (kept.areaErrorShare > options.areaTolerance) {
    monitor.warn(printed("areas are off by %.2f %% of the whole, where %.2f %% counts as kept",
                         100 * kept.areaErrorShare, 100 * options.areaTolerance));
  }
}

/// What the result is not, of the state that is kept.
Flag flagOf(const UnfoldOptions& options, const UnfoldResult& result, const IterationRecord& kept,
            double seen) {
  const IterationRecord& start = result.history.front();
  if (result.history.back().iteration > start.iteration && kept.visibility <= start.visibility) {
    return Flag::Worse;
  }
  if (!reachedGoal(result.termination) && result.termination != Termination::Stalled) {
    return Flag::None;  // it was stopped on the way
  }
  if (options.unfolder.surround == Surround::Elastic && kept.collarStretchMax > kCollarMost &&
      kept.collarStretchMean > kCollarMean) {
    return Flag::Stretched;
  }
  const bool met = meetsGoals(goalOf(options), kept.visibility, seen, kept.edgeStrainMean);
  return met && kept.areaErrorShare <= options.areaTolerance ? Flag::None : Flag::Held;
}

/// Says what a user must know about the result, and does not call it what it is not.
/// @param seen  share of the region's area
void judge(const UnfoldOptions& options, double seen, const Monitor& monitor,
           UnfoldResult& result) {
  const IterationRecord& kept = result.history[static_cast<std::size_t>(result.iteration)];
  const IterationRecord& last = result.history.back();
  if (result.iteration != last.iteration) {
    monitor.warn(
        printed("the run ended at a visibility of %.3f, worse than the best state seen; that one, "
                "of iteration %d at %.3f, is kept",
                last.visibility, result.iteration, kept.visibility));
  }
  result.flag = flagOf(options, result, kept, seen);
  if (result.flag == Flag::Worse) {
    monitor.warn("no state is better than the start, which is kept: nothing is unfolded");
  } else if (result.flag != Flag::None) {
    sayWhatIsShort(options, kept, seen, monitor);
  }
  if (result.flag != Flag::None && reachedGoal(result.termination)) {
    result.termination = Termination::Stalled;
  }
}

UnfoldResult unfoldHere(const TriangleMesh& mesh, const Region& region,
                        const visibility::Viewpoints& viewpoints, const UnfoldOptions& options,
                        const Monitor& monitor, const Checkpoint* resume) {
  const Continuation continuation(options);
  const Stopwatch elapsed;
  Unfolder unfolder(mesh, region, viewpoints, solverOptions(options));
  UnfoldResult result;
  const double initial = unfolder.record().visibility;
  requirePositive(initial);
  std::vector<Positions> path;
  BestState best;
  if (resume != nullptr) {
    unfolder.restore(resume->state);
    result.history = resume->history;
    path = resume->path;
    best = resume->best;
    if (best.moving.rows() == 0) {  // a state that no run of this function left
      best = {unfolder.state().iteration, unfolder.record().visibility,
              unfolder.record().edgeStrainMean, movingOnly(unfolder)};
    }
  } else {
    best = {0, initial, 0, movingOnly(unfolder)};
    result.history.push_back(unfolder.record());
  }
  if (options.frames > 0 && path.empty()) path.push_back(movingOnly(unfolder));

  const Monitor* const asking = StopScope::current();
  const StopScope kept(nullptr);  // what is reached is returned ...
  const double earlier = result.history.back().seconds;
  const double goal = options.targetVisibility.value_or(1.0);
  const auto reason = [&] {
    // Before the continuation, which steers: a run that goes on from here is steered once.
    if (monitor.shouldStop()) return Termination::Interrupted;
    const UnfoldState before = unfolder.state();
    const std::vector<std::int32_t> movedThen = unfolder.movingVertices();
    const bool isFirstLook = unfolder.state().look.iteration < 0;
    const Termination byItself = continuation.next(unfolder, result.history);
    considerLook(unfolder, isFirstLook, best);
    const bool grown = unfolder.movingVertices().size() != movedThen.size();
    if (grown) {
      addStanding(unfolder, movedThen, best.moving);
      for (Positions& state : path) addStanding(unfolder, movedThen, state);
    }
    if (byItself != Termination::NotRun) return byItself;
    try {
      const StopScope heard(grown ? nullptr : asking);  // ... but for a step, which is given up
      return unfolder.step() ? Termination::NotRun : Termination::Stalled;
    } catch (const Interrupted&) {
      unfolder.restore(before);
      return Termination::Interrupted;
    }
  };
  while ((result.termination = reason()) == Termination::NotRun) {
    result.history.push_back(unfolder.record());
    result.history.back().seconds = earlier + elapsed();
    if (options.frames > 0) path.push_back(movingOnly(unfolder));
    consider(unfolder, options, best);
    tellProgress(monitor, unfolder.record(), initial, goal);
  }
  const double seen = chooseState(unfolder, viewpoints, best, options, result);
  judge(options, seen, monitor, result);
  std::vector<Positions> whole = path;
  if (options.frames > 0) path.resize(static_cast<std::size_t>(result.iteration) + 1);
  result.frames = framesAlong(unfolder, viewpoints, path, options.frames);
  result.region = unfolder.region();
  result.collar = unfolder.collarFaces();
  result.checkpoint = {unfolder.state(), std::move(best), result.history, std::move(whole)};
  return result;
}

}  // namespace

Point originNear(const Point& middle) {
  constexpr double kNear = 1000;  // mm
  return middle.norm() > kNear ? Point(middle.array().round()) : Point(Point::Zero());
}

double merit(double visibility, double strain, double seen, double trade) {
  const double spare = std::min(visibility - kGoalVisibility, (kGoalStrain - strain) / trade);
  return seen < kGoalSeen ? std::min(spare, seen - kGoalSeen) : spare;
}

bool meetsGoals(double goal, double visibility, double seen, double strain) {
  return visibility >= goal && seen >= std::min(goal, kGoalSeen) && strain <= kGoalStrain;
}

bool isBetter(const IterationRecord& state, const BestState& than, bool towardsTarget, double seen,
              double trade) {
  if (towardsTarget) return state.visibility > than.visibility;
  return merit(state.visibility, state.edgeStrainMean, seen, trade) >
         merit(than.visibility, than.strain, than.seen, trade);
}

UnfolderOptions solverOptions(const UnfoldOptions& options) {
  UnfolderOptions solver = options.unfolder;
  solver.areaSlack = options.areaTolerance;  // of a face: the mean ends below
  return solver;
}

UnfoldResult unfold(const TriangleMesh& mesh, const Region& region,
                    const visibility::Viewpoints& viewpoints, const UnfoldOptions& options,
                    const Monitor& monitor, const Checkpoint* resume) {
  const Point origin = originNear(centroidOf(mesh, region));
  if (origin.isZero()) return unfoldHere(mesh, region, viewpoints, options, monitor, resume);
  TriangleMesh moved = mesh;
  moved.positions.rowwise() -= origin.transpose();
  visibility::Viewpoints eyes = viewpoints;
  for (Point& eye : eyes.points) eye -= origin;
  UnfoldResult result = unfoldHere(moved, region, eyes, options, monitor, resume);
  result.mesh.positions.rowwise() += origin.transpose();
  for (UnfoldFrame& frame : result.frames) frame.positions.rowwise() += origin.transpose();
  return result;
}

}  // namespace explica::unfolding
