// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Frames.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Termination.h"
#include "Explica/Flattening/Disc.h"
#include "Explica/Flattening/MapEnergy.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace explica::flattening {

/// What a flat map is to keep, and when to stop.
struct FlattenOptions {
  double areaTolerance = 0.01;  ///< mean relative area error to reach: w of mapDensity() rises
                                ///< until the map has it
  double contactRange = 0.2;    ///< rim edges nearer than this share of the mean edge repel
  double tolerance = 1e-4;  ///< stop once a Newton step promises to lower the energy by less than
                            ///< this share of it
  int maxIterations = 200;  ///< Newton iterations at full resolution, > 0
  int frames = 0;           ///< states to keep, evenly spaced along the way of the vertices
};

template <class Visitor>
void describe(FlattenOptions& options, Visitor&& visit) {
  visit(Field{"area-tolerance", "", "mean relative area error of faces that the map is to have",
              1e-6, 1},
        options.areaTolerance);
  visit(Field{"contact-range", "", "rim edges nearer than this share of the mean edge repel", 1e-6,
              10},
        options.contactRange);
  visit(Field{"tolerance", "", "stop once a step promises less than this share of the energy",
              1e-12, 1},
        options.tolerance);
  visit(Field{"max-iterations", "", "Newton iterations at full resolution at most", 1, 1e6},
        options.maxIterations);
  visit(Field{"frames", "",
              "states to write on the way, evenly spaced along the way that vertices go", 0,
              kMostFrames},
        options.frames);
}

/// The map on the vertices of one level.
struct FlatStage {
  int level = -1;           ///< 0 is the disc itself
  FlatPositions positions;  ///< of the level's vertices in ascending order
};

/// Where a map is on its way: what flatten() needs to go on.
struct FlattenState {
  std::uint64_t disc = 0;  ///< sumOver() the disc that it belongs to
  int level = -1;          ///< -1: not begun
  int iterations = 0;      ///< made at this level
  double areaWeight = kNaN;
  double areaTolerance = kNaN;  ///< that was aimed at
  bool settled = false;         ///< areas are kept; the last descent
  FlatPositions positions;      ///< of the level's vertices in ascending order
  std::vector<FlatStage> path;  ///< after each iteration, if frames were asked for
};

struct FlatMap {
  FlatPositions positions;        ///< of the disc's vertices, mm, exact in single precision
  std::int64_t turnedOver = 0;    ///< faces not counter-clockwise; exact
  std::int64_t rimCrossings = 0;  ///< pairs of rim edges that meet; exact
  double energy = kNaN;
  int iterations = 0;           ///< at full resolution
  double areaWeight = kNaN;     ///< w of mapDensity() that was needed
  std::size_t raisedFaces = 0;  ///< needles of the reference whose height was raised
  Termination termination = Termination::NotRun;
  std::vector<FlatPositions> frames;  ///< of the disc's vertices, as `positions`
  FlattenState state;
};

/// Lays a disc flat: one-to-one, areas kept closely, lengths as well as can be.
///
/// Vertices are taken out down to a few hundred, which are mapped into a circle (one-to-one by
/// [Tutte1963, Floater2003]) and let go; then they are put back in reverse, each where all its
/// faces are positive, and the energy of MapEnergy.h is lowered at every level by projected Newton
/// steps that no face and no two rim edges can cross.  Holes are closed by a fan of faces of little
/// weight, so that they stay open and do not fold.
///
/// Deterministic, and the same for any number of threads.  The map is turned so that the
/// reference's z axis (or its y axis, for a piece that lies level) points up, and centred.
///
/// A run that is stopped gives the map as far as it came, one-to-one as ever: vertices that are
/// still missing are put back where there is room for them.  Frames begin with the map into a
/// circle and are one-to-one, too, up to rounding.
///
/// @param resume  continue from here: the result equals that of a run which never stopped
/// @throws InvalidInput  option out of range; a state of another disc
[[nodiscard]] FlatMap flatten(const Disc& disc, const FlattenOptions& options = {},
                              const Monitor& monitor = {}, const FlattenState* resume = nullptr);

/// A sum over a disc's vertices and faces, by which a state knows its own.
[[nodiscard]] std::uint64_t sumOver(const Disc& disc);

/// Faces whose corners do not run counter-clockwise; exact.
[[nodiscard]] std::int64_t countTurnedOver(const Faces& faces, const FlatPositions& flat);

}  // namespace explica::flattening
