// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Collision/Untangling.h"
#include "Explica/Core/Monitor.h"
#include "Explica/Core/Results.h"

#include <span>
#include <string>
#include <vector>

namespace explica::collision {

struct RepairOptions {
  double maxMove = 0.75;  ///< mm that a vertex may go, > 0; groups that need more stay as they were
};

/// One surface of a repair.
struct RepairedSurface : Untangling {
  std::size_t putBackFar = 0;    ///< groups that would have moved farther than allowed
  std::size_t putBackOther = 0;  ///< groups that would have met another of the surfaces
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

/// A repair in numbers: of one surface, or of all together.
struct RepairCounts {
  std::size_t before = 0, after = 0;  ///< intersecting pairs of faces
  std::size_t moved = 0;              ///< vertices
  std::size_t putBack = 0;            ///< groups of vertices
  double moveMean = 0, moveMax = 0;   ///< mm, of the moved vertices
};
[[nodiscard]] RepairCounts countsOf(const RepairedSurface& surface);

struct RepairSummary {
  struct Part {
    std::string name;
    RepairCounts counts;
  };
  RepairCounts all;
  std::vector<Part> surfaces;
};

/// @param names  one a surface
[[nodiscard]] RepairSummary summaryOf(std::span<const RepairedSurface> surfaces,
                                      std::span<const std::string> names);

inline void describe(Results& t, const RepairCounts& r) {
  t.count("pairs_before", "Intersecting pairs of faces at the start", "", r.before);
  t.count("pairs_after", "Intersecting pairs of faces", "Found by an exact test.", r.after)
      .after("pairs_before")
      .exactly(0, Judgement::Doubt, "a surface does not cross itself")
      .inHead();
  t.count("vertices_moved", "Vertices moved", "All others keep every bit.", r.moved).inHead();
  t.number("move_mean", "Mean displacement", "mm", "Of the moved vertices.", r.moveMean).inHead();
  t.number("move_max", "Largest displacement", "mm", "", r.moveMax).inHead();
}

inline void describe(Results& t, const RepairSummary::Part& r) {
  t.text("surface", "Surface", "", r.name);
  describe(t, r.counts);
}

inline void describe(Results& t, const RepairSummary& r) {
  describe(t, r.all);
  t.count("groups_put_back", "Groups of vertices put back",
          "They would have moved farther than allowed, or met another of the surfaces.",
          r.all.putBack);
  t.each("surfaces", "Each surface", "The same numbers of each surface.", r.surfaces);
}

}  // namespace explica::collision
