// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Frames.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Termination.h"
#include "Explica/Unfolding/Unfold.h"

#include <string>
#include <vector>

namespace explica::inflation {

/// How to inflate and when to stop.
struct InflateOptions {
  double targetSeen = 0.98;    ///< global visibility to reach, see visibility::lookFromSphere()
  double smoothing = 0.15;     ///< reach of DirectionField, of the radius of a sphere of the area
  int lookEvery = 4;           ///< iterations between two looks from the enclosing sphere, > 0
  int viewpoints = 64;         ///< on the enclosing sphere
  double springWeight = 2.4;   ///< stiffness of edge lengths, see unfolding::kTerms
  double areaWeight = 20;      ///< stiffness of face areas before it is tightened
  double contactRange = 0.25;  ///< of the mean edge length: the contact barrier acts below it
  int maxIterations = 300;     ///< > 0
  int frames = 0;              ///< states to keep, evenly spaced in visibility
};

template <class Visitor>
void describe(InflateOptions& options, Visitor&& visit) {
  visit(Field{"target-seen", "",
              "stop at this global visibility: at least as much of the area is then seen from "
              "somewhere",
              kAboveZero, 1},
        options.targetSeen);
  visit(Field{"frames", "", "states to write on the way, evenly spaced in visibility", 0,
              kMostFrames},
        options.frames);
  visit(Field{"max-iterations", "", "iterations at most", 1, unfolding::kMostIterations},
        options.maxIterations);
  visit(Field{"smoothing", "",
              "how far along the surface directions are averaged, as a share of the radius of a "
              "sphere of its area: more makes it rounder",
              0.01, 10},
        options.smoothing);
  visit(Field{"look-every", "", "iterations between two looks from the enclosing sphere", 1, 1000},
        options.lookEvery);
  visit(Field{"viewpoints", "", "points of the enclosing sphere", 12, 10000}, options.viewpoints);
  visit(Field{"spring-weight", "", "stiffness of edge lengths", 0, 1e6}, options.springWeight);
  visit(Field{"area-weight", "", "stiffness of face areas before it is tightened", kAboveZero, 1e6},
        options.areaWeight);
  visit(Field{"contact-range", "", "reach of the contact barrier in mean edge lengths", kAboveZero,
              10},
        options.contactRange);
}

/// One iteration's account: a row of evolution.tsv.
struct InflateRecord {
  unfolding::IterationRecord step;  ///< its `visibility` is the mean of n . d, by area
  double visibility = kNaN;  ///< global, [0, 1]; of the last look at or before this iteration
  double seen = kNaN;        ///< share of the area that any viewpoint saw then
};

/// A state on the way.
struct InflateFrame {
  double visibility = kNaN;  ///< global
  Positions positions;       ///< V x 3
};

struct InflateResult {
  TriangleMesh mesh;
  Termination termination = Termination::NotRun;
  unfolding::Flag flag = unfolding::Flag::None;
  std::vector<InflateRecord> history;  ///< the start and every iteration
  std::vector<InflateFrame> frames;
  unfolding::Checkpoint checkpoint;  ///< see unfolding::writeCheckpoint()
};

/// Opens a closed surface as a whole until it is seen from all around.
///
/// The surface is looked at from an enclosing sphere (visibility::lookFromSphere()), and every face
/// turns towards the mean direction in which its place sees the sphere; areas are kept, edges keep
/// their lengths as well as they can, and no step lets the surface pass through itself
/// (unfolding::Unfolder).  Directions are found anew every few iterations.  A surface whose global
/// visibility settles below the goal is driven harder, up to four times; beyond that it ends as
/// Stalled.
///
/// @param mesh    closed, connected, oriented either way
/// @param resume  continue from here: the result equals that of a run which never stopped
/// @throws InvalidInput  not closed or in several pieces; a face of zero area; a surface that
///                       touches itself; an option out of range; a checkpoint of another surface
///
/// Results are the same for any number of threads.
[[nodiscard]] InflateResult inflate(const TriangleMesh& mesh, const InflateOptions& options = {},
                                    const Monitor& monitor = {},
                                    const unfolding::Checkpoint* resume = nullptr);

/// The history as a table, tab-separated with a header.
[[nodiscard]] std::string evolutionTable(const std::vector<InflateRecord>& history);

}  // namespace explica::inflation
