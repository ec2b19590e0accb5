// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Geometry/SelfIntersection.h"

#include <vector>

namespace explica::collision {

struct UntangleOptions {
  /// F flags: crossings with none of these faces stay; empty: all
  std::vector<bool> concerned = {};
};

/// A surface with its self-intersections removed as far as that went.
struct Untangling {
  Positions positions;                     ///< V x 3; vertices that did not move keep their bits
  std::vector<geometry::FacePair> before;  ///< of the input, sorted
  std::vector<geometry::FacePair> after;   ///< those that are left, sorted
  std::vector<std::int32_t> moved;         ///< vertices, ascending
  double moveMax = 0;                      ///< mm
  double moveMean = 0;                     ///< mm, of the moved vertices

  /// Lists the vertices that are not where they were, and measures how far they moved.
  void noteMoves(const Positions& start);
};

/// Separates faces that intersect by moving few vertices a little.
///
/// Each group of crossing pairs is mended by itself, its vertices and first one ring about them
/// free, then two, and so on.  Two ways are tried and the one kept that leaves fewer crossings,
/// then the one that moves less: descent on the length of the segments in which faces cross
/// [Volino2006], with a Sobolev metric so that neighbours follow; and the smooth surface (uniform
/// bi-Laplacian) through the rim, held to the old positions by a falling weight, which opens folds.
///
/// A group's new positions are kept only if the exact test finds fewer intersecting pairs than
/// before and none that is not among those of the input.  That needs no continuous test: the rim of
/// the piece that moved stands still, so a piece that crosses nothing is on the side where its rim
/// is.  Moved positions are multiples of single precision, in which files keep them.
///
/// @throws InvalidInput  another number of flags than of faces, or as geometry::buildTopology()
///
/// A stop that the monitor asks for leaves the groups that were mended by then.
///
/// Deterministic; does not depend on threads.
[[nodiscard]] Untangling untangle(const TriangleMesh& mesh, const UntangleOptions& options = {},
                                  const Monitor& monitor = {});

}  // namespace explica::collision
