// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Flattening/Comparison.h"
#include "Explica/Unfolding/Distortion.h"

#include <span>
#include <string>
#include <vector>

namespace explica::unfolding {

/// What a surface keeps of the reference with the same vertices.
struct SurfaceComparison {
  std::string name;
  Distortion distortion;
  flattening::DistanceErrors distances;
  std::int64_t turnedOver = 0;  ///< faces
  std::size_t crossings = 0;    ///< pairs of faces
  double seen = kNaN;           ///< share of the area (flattening::seenShare)
};

inline void describe(Results& t, const SurfaceComparison& c) {
  t.text("surface", "Surface", "The file whose numbers follow.", c.name);
  describe(t, c.distortion);
  describe(t, c.distances);
  t.number("scale_local", "Scale of near distances", "", "", c.distances.local.scale);
  t.number("scale_all", "Scale of all distances", "", "", c.distances.all.scale);
  t.count("turned_over", "Faces turned over", "Exact on flat maps.", c.turnedOver)
      .exactly(0, Judgement::Look, "one-to-one")
      .inHead();
  t.count("crossings", "Intersecting pairs of faces", "Found by an exact test.", c.crossings)
      .exactly(0, Judgement::Look, "a surface does not cross itself")
      .inHead();
  t.share("seen", "Seen",
          "Share of the area that rays reach: from above for a flat map, else from all sides.",
          c.seen)
      .inHead();
}

struct Comparison {
  std::size_t faces = 0;  ///< that are compared
  std::vector<SurfaceComparison> surfaces;
};

inline void describe(Results& t, const Comparison& c) {
  t.count("faces", "Faces compared", "Those that all surfaces have.", c.faces);
  describe(t, c.surfaces.empty() ? SurfaceComparison{} : c.surfaces.front());
  t.each("surfaces", "Each surface", "The same numbers of each surface.", c.surfaces);
}

/// Compares surfaces with the reference on the listed faces: distortion, distances between the same
/// pairs of vertices for all (straight on flat maps, along the surface on others), faces turned
/// over, self-intersections and what is seen.  Interrupted after the first surface, it holds
/// those that are measured.
/// @param names  of the surfaces, for the account
/// @throws InvalidInput  sizes that differ, or no face
[[nodiscard]] Comparison compareSurfaces(const TriangleMesh& reference,
                                         std::span<const TriangleMesh> surfaces,
                                         std::span<const std::string> names,
                                         std::span<const std::int32_t> faces,
                                         const flattening::DistanceOptions& options = {},
                                         const Monitor& monitor = {});

}  // namespace explica::unfolding
