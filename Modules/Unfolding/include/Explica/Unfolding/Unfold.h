// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Core/Termination.h"
#include "Explica/Unfolding/Unfolder.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace explica::unfolding {

/// How to unfold and when to stop.
struct UnfoldOptions {
  UnfolderOptions unfolder;
  std::optional<double> targetVisibility;  ///< stop once the average visibility reaches it
  double areaTolerance = 0.002;            ///< ... and the mean relative area error is below this
  int maxIterations = 500;                 ///< > 0
  std::optional<double> maxTime;           ///< s, of this run
  int frames = 0;                          ///< states to keep, evenly spaced in visibility
};

template <class Visitor>
void describe(UnfoldOptions& options, Visitor&& visit) {
  describe(options.unfolder, visit);
  visit(Field{"target-visibility", "",
              "stop once the average visibility reaches this; without it, once it no longer rises"},
        options.targetVisibility);
  visit(Field{"area-tolerance", "", "mean relative area error of faces that a goal asks for"},
        options.areaTolerance);
  visit(Field{"max-iterations", "", "iterations at most"}, options.maxIterations);
  visit(Field{"max-time", "s", "stop after this time"}, options.maxTime);
  visit(Field{"frames", "", "states to write on the way, evenly spaced in visibility"},
        options.frames);
}

/// A state on the way.
struct UnfoldFrame {
  double visibility = kNaN;
  Positions positions;  ///< V x 3
};

/// A run that can go on: state, account so far, and the way there if frames were asked for.
struct Checkpoint {
  UnfoldState state;
  std::vector<IterationRecord> history;
  std::vector<Positions> path;  ///< moving vertices after each iteration, from the start on
};

struct UnfoldResult {
  TriangleMesh mesh;  ///< all vertices; the region's faces only with Surround::None
  Region region;      ///< faces are rows of mesh.faces
  Termination termination = Termination::NotRun;
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
/// A target that is out of reach ends as Stalled; without a target, no more progress is Converged.
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
