// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/Curve.h"

#include <vector>

namespace explica::planar {

/// A vertex and an edge that does not hold it: all that can meet first when a curve moves.
struct VertexEdgePair {
  int vertex = 0;
  int edge = 0;
  double range = 0;  ///< mm; the barrier acts below this distance
};

/// Nearest point of an edge to a vertex.
struct VertexEdgeDistance {
  double distance = 0;     ///< mm
  double parameter = 0;    ///< in [0, 1] along the edge
  Point2 direction{0, 0};  ///< unit, from the edge's point to the vertex
};

[[nodiscard]] VertexEdgeDistance vertexEdgeDistance(const Curve& curve, int vertex, int edge);

/// Pairs that have a moving vertex and lie within `reach` mm.  The barrier's range of a pair is
/// `range`, or half the rest length of an edge that joins both if that is less, so that no pair is
/// pushed by the mere sampling of the curve.
/// @param restLengths  one an edge, mm: those of the start, so that no edge can shrink to nothing
[[nodiscard]] std::vector<VertexEdgePair> nearbyPairs(const Curve& curve,
                                                      const std::vector<bool>& moving,
                                                      const Eigen::VectorXd& restLengths,
                                                      double range, double reach);

/// Largest t in [0, 1] found such that all pairs stay apart while vertices go straight from
/// curve.positions to `target`: continuous collision detection by conservative advancement
/// [Li2021].  Distances keep at least half of their start at every time before.  Never larger
/// than the true time of contact; 0 for a pair that touches.
[[nodiscard]] double largestSafeStep(const Curve& curve, const Positions2& target,
                                     const std::vector<VertexEdgePair>& pairs);

/// Clamped logarithmic barrier b = -(d/range - 1)^2 ln(d/range), twice differentiable, zero from
/// range on, infinite at contact.
struct BarrierValue {
  double value = 0;
  double slope = 0;      ///< db/dd, 1/mm
  double curvature = 0;  ///< d2b/dd2, 1/mm^2
};
[[nodiscard]] BarrierValue barrier(double distance, double range);

/// Least distance of a curve to itself over pairs that do not share a vertex, mm.
[[nodiscard]] double leastDistance(const Curve& curve, const std::vector<VertexEdgePair>& pairs);

}  // namespace explica::planar
