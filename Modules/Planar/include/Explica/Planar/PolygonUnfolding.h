// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Termination.h"
#include "Explica/Planar/Curve.h"
#include "Explica/Planar/PolygonKnotEnergy.h"
#include "Explica/Planar/PolygonVisibility.h"

#include <array>
#include <filesystem>
#include <vector>

namespace explica::planar {

/// How a region is moved.
enum class PolygonMethod {
  Implicit,  ///< constrained Newton steps with exact lengths, barrier and collision detection
  Thesis     ///< explicit flow with first-order length projection, [Thesis, Eq. 4.20 and 4.23]
};
constexpr auto enumWords(PolygonMethod) {
  using enum PolygonMethod;
  return std::to_array<EnumWord<PolygonMethod>>({{Implicit, "implicit"}, {Thesis, "thesis"}});
}

/// What happens to the polygon outside the region.
enum class PolygonSurround {
  Fixed,    ///< stays where it is and is an obstacle
  Elastic,  ///< a collar of some edges on both sides follows
  None      ///< absent: the region alone, an open chain
};
constexpr auto enumWords(PolygonSurround) {
  using enum PolygonSurround;
  return std::to_array<EnumWord<PolygonSurround>>(
      {{Fixed, "fixed"}, {Elastic, "elastic"}, {None, "none"}});
}

struct PolygonUnfoldingOptions {
  PolygonMethod method = PolygonMethod::Implicit;
  PolygonSurround surround = PolygonSurround::Fixed;
  int collar = 4;            ///< edges on each side that follow with PolygonSurround::Elastic
  bool noLength = false;     ///< let the region's edges change their length
  bool noTopology = false;   ///< no knot energy, no barrier, no collision detection
  bool noCollision = false;  ///< the knot energy alone keeps edges apart, as in the thesis
  PolygonKnot knot = PolygonKnot::Auto;
  double knotWeight = 0.02;         ///< implicit method: knot energy against total flux
  double targetVisibility = 0.995;  ///< variance is then below 0.01, since f^2 <= 1
  int maxIterations = 20000;
  double visibilityGain = 1000;  ///< thesis method: mu of [Thesis, Eq. 4.15]
  double repulsionGain = 0.02;   ///< thesis method: mu_R of [Thesis, Eq. 4.20]
  double explicitStep = 0.01;    ///< thesis method: largest motion per iteration, in mean edges
};

template <class Visitor>
void describe(PolygonUnfoldingOptions& options, Visitor&& visit) {
  visit(Field{"method", "", "implicit steps, or the thesis's explicit flow"}, options.method);
  visit(Field{"surround", "", "what happens to the polygon outside the region"}, options.surround);
  visit(Field{"collar", "", "edges on each side that follow an elastic surround", 1, 1e6},
        options.collar);
  visit(Field{"no-length", "", "let edges of the region change their length"}, options.noLength);
  visit(Field{"no-topology", "", "let edges cross: no repulsion, no collision detection"},
        options.noTopology);
  visit(Field{"no-collision", "",
              "no barrier and no collision detection: the knot energy alone keeps edges apart, as "
              "in the thesis"},
        options.noCollision);
  visit(Field{"knot", "", "how the knot energy is summed"}, options.knot);
  visit(Field{"knot-weight", "", "implicit method: weight of the knot energy"}, options.knotWeight);
  visit(Field{"target-visibility", "", "stop at this average visibility"},
        options.targetVisibility);
  visit(Field{"max-iterations", "", "stop after this many iterations", 0, 1e9},
        options.maxIterations);
  visit(Field{"visibility-gain", "", "thesis method: mu, the weight of the visibility"},
        options.visibilityGain);
  visit(Field{"repulsion-gain", "", "thesis method: mu_R, the weight of the knot energy"},
        options.repulsionGain);
  visit(Field{"explicit-step", "", "thesis method: largest motion per iteration, in mean edges"},
        options.explicitStep);
}

/// One iteration's account.
struct PolygonIteration {
  int iteration = 0;
  double visibility = 0;
  double variance = 0;
  double length = 0;         ///< of the region, mm
  double lengthError = 0;    ///< largest relative change of a region edge's length
  double leastDistance = 0;  ///< mm, over pairs in reach; infinite if none
  double knotEnergy = 0;     ///< mm, up to a constant
  double step = 0;           ///< largest motion of a vertex, mm
  double seconds = 0;        ///< since the start
};

/// A state on the way.  Only without length preservation the number of vertices changes.
struct PolygonState {
  Positions2 positions;
  Region region;
};

/// What the implicit method takes from one iteration to the next.
struct PolygonMethodState {
  double damping = 1;
  Eigen::VectorXd tension = {};  ///< one a kept edge, 1/mm; empty of the thesis's method
};

/// All that a run needs to go on, and of what it is a state.
struct PolygonCheckpoint {
  Positions2 input;  ///< the polygon, region and view that the run was given
  Region inputRegion;
  Viewpoints view;
  PolygonMethod method = PolygonMethod::Implicit;
  PolygonState posed;  ///< since the last merge of vertices; lengths are kept against it
  PolygonMethodState methodState;
  std::vector<PolygonIteration> history;
  std::vector<PolygonState> path;
  int verticesMerged = 0;
  int firstCrossing = -1;
};

/// Writes a checkpoint: little-endian numbers and a check sum.
/// @throws EnvironmentError  the file cannot be written
void writeCheckpoint(const std::filesystem::path& path, const PolygonCheckpoint& checkpoint);

/// @throws IOError  missing, truncated or no checkpoint
[[nodiscard]] PolygonCheckpoint readCheckpoint(const std::filesystem::path& path);

/// The unfolded polygon and how it came about.
struct PolygonUnfolding {
  Curve curve;    ///< all vertices in their order; with PolygonSurround::None the region alone
  Region region;  ///< in `curve`
  std::vector<PolygonIteration> history;  ///< first entry is the start
  std::vector<PolygonState> path;         ///< the state at every history entry
  int verticesMerged = 0;                 ///< of edges that shrank away; noLength only
  Termination termination = Termination::NotRun;
  double seconds = 0;
  double secondsTopology = 0;  ///< of these for knot energy, barrier and collision detection
  std::vector<std::array<int, 2>> intersectionsInitial;  ///< edge pairs, exact
  std::vector<std::array<int, 2>> intersectionsFinal;
  int firstCrossing = -1;        ///< iteration after which edges crossed first; -1 never
  PolygonCheckpoint checkpoint;  ///< from which the run goes on
};

/// Moves the region's vertices until its average visibility from a viewpoint reaches the target.
///
/// Lengths of the region's edges are constraints of every step, [Thesis, Eq. 4.21], met to 1e-6 by
/// the implicit method and to first order by the thesis's.  Unless `noTopology` or
/// `noCollision`, no accepted step lets edges meet: it ends before the first contact of any vertex
/// with any edge.  With `noLength`, edges that have shrunk to a quarter of the mean are merged into
/// a vertex, as in the thesis.
///
/// @param view    mm, outside the polygon
/// @param resume  where an earlier run on the same polygon, region and view stood: the result is
/// bit
///                by bit that of one run, as long as the options but for the limits are the same
/// @throws InvalidInput  unusable curve, a clockwise polygon, a region that already crosses itself
///                       (unless noTopology), an initial average visibility that is not positive
///                       (the flow would be a backward diffusion), an option out of range, or a
///                       state of another run
[[nodiscard]] PolygonUnfolding unfoldPolygon(const Curve& curve, const Region& region,
                                             const Viewpoints& view,
                                             const PolygonUnfoldingOptions& options = {},
                                             const Monitor& monitor = {},
                                             const PolygonCheckpoint* resume = nullptr);

}  // namespace explica::planar
