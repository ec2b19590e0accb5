// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <array>
#include <vector>

namespace explica::planar {

using Point2 = Eigen::Vector2d;  ///< mm

/// A polygon, or an open chain of edges, in the plane.
///
/// Edge i joins vertex i to its successor; a polygon closes from its last vertex to its first, and
/// runs counter-clockwise, so that the tissue lies to the left of every edge.
struct Curve {
  Positions2 positions;  ///< V x 2, mm
  bool closed = true;

  [[nodiscard]] int vertexCount() const { return static_cast<int>(positions.rows()); }
  [[nodiscard]] int edgeCount() const { return closed ? vertexCount() : vertexCount() - 1; }
  [[nodiscard]] int next(int vertex) const { return vertex + 1 == vertexCount() ? 0 : vertex + 1; }
  [[nodiscard]] Point2 point(int vertex) const { return positions.row(vertex).transpose(); }
};

/// Consecutive edges of a curve; of a closed curve they may run past its last vertex.
struct Region {
  int firstEdge = 0;
  int edgeCount = 0;

  [[nodiscard]] bool operator==(const Region&) const = default;
};

/// Region from vertex `first` to vertex `last` along the curve's order.
/// @throws InvalidInput  a vertex out of range, no edge between them, or past an open curve's end
[[nodiscard]] Region regionBetween(const Curve& curve, int first, int last);

/// The whole curve.
[[nodiscard]] Region wholeRegion(const Curve& curve);

/// What of a closed curve faces a viewpoint: from the vertex that one extremity of the view meets
/// to that of the other (4.2 of the thesis).
/// @throws InvalidInput  an open curve, or a viewpoint that sees it over half a turn or more
[[nodiscard]] Region regionFacing(const Curve& curve, const Point2& viewpoint);

/// Edges of a region, in order.
[[nodiscard]] std::vector<int> edgesOf(const Curve& curve, const Region& region);

/// Vertices of a region, in order: one more than edges, unless the region is a whole closed curve.
[[nodiscard]] std::vector<int> verticesOf(const Curve& curve, const Region& region);

/// Length of every edge, mm.
[[nodiscard]] Eigen::VectorXd edgeLengths(const Curve& curve);

/// Length of a region, mm.
[[nodiscard]] double lengthOf(const Curve& curve, const Region& region);

/// Centre of a region's length, mm.
[[nodiscard]] Point2 centroidOf(const Curve& curve, const Region& region);

/// Area with sign, mm^2: positive if the closed curve runs counter-clockwise.
[[nodiscard]] double signedArea(const Positions2& polygon);

/// Least distance of a point from a curve's edges, mm.
[[nodiscard]] double distanceTo(const Curve& curve, const Point2& point);

/// True if the segments (a, b) and (c, d) share a point, by exact predicates.
[[nodiscard]] bool segmentsMeet(const Point2& a, const Point2& b, const Point2& c, const Point2& d);

/// Pairs of edges i < j that share a point other than the vertex that joins them, by exact
/// predicates: an empty list says that the curve is simple.  O(n log n) for edges of like size.
/// @throws InvalidInput  more than ten million pairs do: that is no outline
[[nodiscard]] std::vector<std::array<int, 2>> intersectingEdges(const Curve& curve);

/// Checks what every algorithm here needs.
/// @throws InvalidInput  fewer than three vertices (two if open), a coordinate that is not finite,
///                       an edge of length zero
void requireUsable(const Curve& curve);

}  // namespace explica::planar
