// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Results.h"
#include "Explica/Core/Termination.h"
#include "Explica/Core/TriangleMesh.h"

#include <array>
#include <utility>
#include <vector>

namespace explica::visibility {

/// A measure of how visible a closed surface is from everywhere, to be made small.
enum class GlobalMeasure {
  HiddenArea,    ///< [Thesis, Eq. 4.6] in space: 2 pi r^2 A + 6 pi r V, see hiddenViewingArea
  SelfOcclusion  ///< [Thesis, Eq. 4.7] in space with a softened edge, see softSelfOcclusion
};

/// A measure with its gradient.
struct GlobalValue {
  double value = 0;    ///< mm^4
  Positions gradient;  ///< V x 3, mm^3; ascends
};

/// 2 pi r^2 A + 6 pi r V, which hiddenViewingArea tends to, exact for polyhedra.
/// @throws InvalidInput  a vertex on or outside the sphere
[[nodiscard]] GlobalValue hiddenAreaValue(const TriangleMesh& mesh, const Point& centre,
                                          double radius);

/// selfOcclusion with steps that rise over cosines from 0 to `softness`,
///
///   E = sum over i, j of A_i A_j s(n_i . d) s(-n_j . d),  d the unit vector from i to j,
///   s(c) = 0 below 0, t^2 (3 - 2 t) with t = c / softness, 1 above,
///
/// so that it has a gradient; 0 for convex surfaces, and selfOcclusion as softness tends to 0.
/// Centroid rule: O(F^2) time.
/// @throws InvalidInput  softness outside of (0, 1]
[[nodiscard]] GlobalValue softSelfOcclusion(const TriangleMesh& mesh, double softness = 0.2);

struct GlobalFlowOptions {
  GlobalMeasure measure = GlobalMeasure::SelfOcclusion;
  int maxIterations = 300;
  double step = 0.1;      ///< largest motion of the first iteration, in mean edges; it falls to 0
  double softness = 0.2;  ///< of softSelfOcclusion
};

/// A state of the flow.
struct GlobalFlowStep {
  int iteration = 0;
  double measure = 0;  ///< mm^4
  double area = 0;     ///< mm^2
  double volume = 0;   ///< mm^3
};

struct GlobalFlow {
  TriangleMesh mesh;
  std::vector<GlobalFlowStep> history;  ///< first entry is the start
  double radius = 0;                    ///< of the viewing sphere, mm
  /// Converged where nothing is hidden any more; Stalled where an edge has shrunk to nothing; else
  /// MaxIterations.
  Termination termination = Termination::NotRun;
};

/// A flow in numbers.
struct GlobalFlowSummary {
  double radius = kNaN;  ///< of the viewing sphere, mm
  GlobalFlowStep start, end;
  Change visibility, seen;    ///< from all around, lookFromSphere()
  std::size_t crossings = 0;  ///< pairs of faces
  Termination stopReason = Termination::NotRun;
};

inline void describe(Results& t, const GlobalFlowSummary& s) {
  t.number("viewing_radius", "Radius of the viewing sphere", "mm", "", s.radius);
  t.change("measure", "Global measure", "mm^4", "What the flow descends on.",
           {s.start.measure, s.end.measure});
  t.change("area", "Area", "mm^2", "", {s.start.area, s.end.area});
  t.change("volume", "Enclosed volume", "mm^3", "", {s.start.volume, s.end.volume});
  t.change("visibility", "Global visibility", "", "", s.visibility);
  t.change("seen", "Seen from somewhere", "share", "", s.seen);
  t.count("self_intersections_final", "Self-intersections", "", s.crossings);
  t.count("iterations", "Iterations", "", s.end.iteration);
  t.text("stop_reason", "Stop reason", "", s.stopReason);
}

/// Descends on a global measure by explicit steps along its gradient over each vertex's area, which
/// shrink to nothing; areas are free and faces may cross.
///
/// There to be looked at, as its twin in the plane: the flow of (4.6) is mean curvature plus a
/// constant, which smooths; that of (4.7) loses the folds' area.
/// @param mesh  closed, faces outward
[[nodiscard]] GlobalFlow descendGlobalMeasure(const TriangleMesh& mesh,
                                              const GlobalFlowOptions& options = {},
                                              const Monitor& monitor = {});

}  // namespace explica::visibility

namespace explica {

template <>
struct EnumNames<visibility::GlobalMeasure> {
  static constexpr std::array table = {
      std::pair{visibility::GlobalMeasure::HiddenArea, "hidden-area"},
      std::pair{visibility::GlobalMeasure::SelfOcclusion, "self-occlusion"}};
};

}  // namespace explica
