// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Termination.h"
#include "Explica/Planar/Curve.h"
#include "Explica/Planar/PolygonUnfolding.h"

#include <array>
#include <optional>
#include <utility>
#include <vector>

namespace explica::planar {

/// A measure of how visible a closed polygon is from everywhere, to be made small.
enum class GlobalMeasure {
  HiddenArc,     ///< [Thesis, Eq. 4.6]: hiddenViewingArc
  SelfOcclusion  ///< [Thesis, Eq. 4.7]: selfOcclusion
};

struct GlobalFlowOptions {
  GlobalMeasure measure = GlobalMeasure::SelfOcclusion;
  std::optional<double> viewingRadius;  ///< mm, of (4.6) about the mean vertex; unset: ten times
                                        ///< the farthest vertex
  int maxIterations = 2000;
  double step = 0.04;  ///< largest motion of the first iteration, in mean edges; it falls to 0
};

/// A state of the flow.
struct GlobalFlowStep {
  int iteration = 0;
  double measure = 0;     ///< mm^2
  double visibility = 0;  ///< average visibility of the region from the viewpoint
  double variance = 0;    ///< of its flux
  double length = 0;      ///< of the region, mm
  int crossings = 0;      ///< pairs of edges that cross
};

struct GlobalFlow {
  Curve curve;
  std::vector<GlobalFlowStep> history;  ///< first entry is the start
  std::vector<PolygonState> path;       ///< the state at every history entry
  /// Converged where nothing is hidden any more; Stalled where an edge has shrunk to nothing, which
  /// is where curve shortening ends; else MaxIterations.
  Termination termination = Termination::NotRun;
};

/// Centre and radius of the viewing circle of (4.6).
struct ViewingCircle {
  Point2 centre = Point2::Zero();
  double radius = 0;
};
[[nodiscard]] ViewingCircle viewingCircle(const Curve& curve, std::optional<double> radius);

/// Descends on a global measure by explicit steps along its exact gradient, which shrink to
/// nothing; all vertices move, lengths are free and edges may cross.
///
/// There to be looked at: section 4.1 of the thesis found that neither flow unfolds.  That of (4.6)
/// is curve shortening; that of (4.7) ends convex, with the folds' length lost.
/// @param region, view  of which the history gives visibility and length
/// @throws InvalidInput  an open curve, a circle that does not hold it, or an option out of range
[[nodiscard]] GlobalFlow descendGlobalMeasure(const Curve& curve, const Region& region,
                                              const Viewpoints& view,
                                              const GlobalFlowOptions& options = {},
                                              const Monitor& monitor = {});

}  // namespace explica::planar

namespace explica {

template <>
struct EnumNames<planar::GlobalMeasure> {
  static constexpr std::array table = {
      std::pair{planar::GlobalMeasure::HiddenArc, "hidden-arc"},
      std::pair{planar::GlobalMeasure::SelfOcclusion, "self-occlusion"}};
};

}  // namespace explica
