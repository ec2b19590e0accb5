// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Frames.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Termination.h"
#include "Explica/Unfolding/Unfolder.h"

#include <array>
#include <filesystem>
#include <optional>
#include <vector>

namespace explica::unfolding {

inline constexpr int kMostIterations = 100000;

/// Goals: a result that misses one is not called converged.
inline constexpr double kGoalVisibility = 0.98;
inline constexpr double kGoalSeen = 0.98;    ///< share of the region's area that is seen
inline constexpr double kGoalStrain = 0.09;  ///< mean edge strain, at most

/// Strain that a visibility of 1 is worth.
inline constexpr double kTrade = 2;

/// How to unfold and when to stop.
struct UnfoldOptions {
  UnfolderOptions unfolder;
  std::optional<double> targetVisibility;  ///< stop once the average visibility reaches it
  double trade = kTrade;                   ///< strain that a visibility of 1 is worth, > 0
  double areaTolerance = 0.002;            ///< ... and faces lost or gained less of the area
  int maxIterations = 500;                 ///< > 0
  int frames = 0;                          ///< states to keep, evenly spaced in visibility
};

template <class Visitor>
void describe(UnfoldOptions& options, Visitor&& visit) {
  describe(options.unfolder, visit);
  visit(Field{"target-visibility", "",
              "stop once the average visibility reaches this; without it, once it no longer rises",
              kAboveZero, 1},
        options.targetVisibility);
  visit(
      Field{"trade", "",
            "strain, in per cent, that one per cent of visibility is worth: where both goals (0.98 "
            "and 9 %) cannot be met, they are missed in this proportion",
            kAboveZero, 1000},
      options.trade);
  visit(Field{"max-iterations", "", "iterations at most", 1, kMostIterations},
        options.maxIterations);
  visit(Field{"frames", "", "states to write on the way, evenly spaced in visibility", 0,
              kMostFrames},
        options.frames);
}

/// A state on the way.
struct UnfoldFrame {
  double visibility = kNaN;
  Positions positions;  ///< V x 3
};

/// The best state that a run has seen among those that keep areas: see isBetter().
struct BestState {
  int iteration = 0;
  double visibility = kNaN;
  double strain = kNaN;  ///< mean edge strain
  Positions moving;      ///< of the vertices that move
  double seen = kNaN;    ///< share of the region's area that is seen; NaN if nobody looked
};

/// Of visibility, or of strain by what it is worth: what differs by less is the same.
inline constexpr double kAccuracy = 1e-3;

/// Where positions are counted from, so that their differences lose no digits: the origin for what
/// lies about `middle` within 1 m of it, else a whole number of mm, so that single-precision
/// positions lose nothing on the way there and back.
[[nodiscard]] Point originNear(const Point& middle);

/// The lesser of what seeing and lengths have to spare, or what the share seen lacks if that is
/// more.
/// @param seen  NaN: nobody looked, and nothing is known to lack
[[nodiscard]] double merit(double visibility, double strain, double seen = kNaN,
                           double trade = kTrade);
/// Whether a result has what an unfolding is to have: `goal` of visibility, no less seen than that
/// or kGoalSeen, and edges strained by kGoalStrain at most.
[[nodiscard]] bool meetsGoals(double goal, double visibility, double seen, double strain);
/// More merit; on the way to a target, the higher visibility.
/// @param seen  of the state
[[nodiscard]] bool isBetter(const IterationRecord& state, const BestState& than,
                            bool towardsTarget = false, double seen = kNaN, double trade = kTrade);
/// How a driver of its own sets up an Unfolder that ends where unfold() does.
[[nodiscard]] UnfolderOptions solverOptions(const UnfoldOptions& options);

/// A run that can go on: state, account so far, and the way there if frames were asked for.
struct Checkpoint {
  UnfoldState state;
  BestState best;
  std::vector<IterationRecord> history;
  std::vector<Positions> path;     ///< moving vertices after each iteration, from the start on
  std::vector<double> notes = {};  ///< of whoever drives an Unfolder in another way than unfold()
};

/// What keeps a result from being what it seems.
enum class Flag {
  None,
  Held,      ///< a goal is missed
  Worse,     ///< no state was better than the start
  Crossing,  ///< faces cross that did not at the start
  Stretched  ///< an elastic collar gave way: see kCollarMean and kCollarMost
};
constexpr auto enumWords(Flag) {
  using enum Flag;
  return std::to_array<EnumWord<Flag>>({{None, ""},
                                        {Held, "held"},
                                        {Worse, "worse"},
                                        {Crossing, "crossing"},
                                        {Stretched, "stretched"}});
}

struct UnfoldResult {
  TriangleMesh mesh;                 ///< all vertices; the region's faces only with Surround::None
  Region region;                     ///< faces are rows of mesh.faces
  std::vector<std::int32_t> collar;  ///< faces outside it with a vertex that moves
  Termination termination = Termination::NotRun;
  Flag flag = Flag::None;
  int iteration = 0;  ///< whose state `mesh` is: the last, or the best seen if that was better
  std::vector<IterationRecord> history;  ///< the start and every iteration
  std::vector<UnfoldFrame> frames;
  Checkpoint checkpoint;
};

/// Unfolds until the goal, a limit or a request to stop; the free form of Unfolder.
///
/// Frames lie on the straight pieces between iterations, which collision detection has cleared, so
/// that their visibilities are evenly spaced from the start's to the end's.
///
/// @param resume  continue from here: the result equals that of a run which never stopped
/// @throws InvalidInput  as Unfolder; average visibility of the start not above zero; option out of
///                       range
///
/// A run never ends worse than the best state it has seen that keeps its areas.  Converged and
/// TargetReached are said of what meetsGoals() only; a run that comes to rest short of a goal ends
/// as Stalled, flag Held, with a warning that names it.
[[nodiscard]] UnfoldResult unfold(const TriangleMesh& mesh, const Region& region,
                                  const visibility::Viewpoints& viewpoints,
                                  const UnfoldOptions& options = {}, const Monitor& monitor = {},
                                  const Checkpoint* resume = nullptr);

/// Writes a checkpoint: little-endian doubles and a check sum.
/// @throws EnvironmentError  the file cannot be written
void writeCheckpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// @throws IOError  missing, truncated or no checkpoint
[[nodiscard]] Checkpoint readCheckpoint(const std::filesystem::path& path);

}  // namespace explica::unfolding
