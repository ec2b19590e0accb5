// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Collision/Untangling.h"
#include "Explica/Core/Monitor.h"

#include <span>
#include <vector>

namespace explica::collision {

struct RepairOptions {
  double maxMove = 0.75;  ///< mm that a vertex may go, > 0; groups that need more stay as they were
  UntangleOptions untangle;
};

/// One surface of a repair.
struct RepairedSurface {
  Positions positions;                     ///< V x 3; vertices that did not move keep their bits
  std::vector<geometry::FacePair> before;  ///< intersecting pairs of the input, sorted
  std::vector<geometry::FacePair> after;   ///< those that are left, sorted
  std::vector<std::int32_t> moved;         ///< vertices, ascending
  double moveMax = 0;                      ///< mm
  double moveMean = 0;                     ///< mm, of the moved vertices
  std::size_t putBackFar = 0;              ///< groups that would have moved farther than allowed
  std::size_t putBackOther = 0;            ///< groups that would have met another of the surfaces
};

/// Parts the self-intersections of surfaces with the same faces, each by itself, as untangle();
/// then puts groups of moved vertices back that went too far or whose faces would meet another of
/// the surfaces where they did not before.  So surfaces that enclose each other still do, and
/// vertices correspond as before.
///
/// @throws InvalidInput  no surface, faces that differ, an option out of range, or as untangle()
///
/// Deterministic; does not depend on threads.
[[nodiscard]] std::vector<RepairedSurface> repairSurfaces(std::span<const TriangleMesh> surfaces,
                                                          const RepairOptions& options = {},
                                                          const Monitor& monitor = {});

}  // namespace explica::collision
