// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Flattening/Selection.h"

#include <map>
#include <string>
#include <vector>

namespace explica::flattening {

/// Values on the vertices of a patch.
struct PatchMap {
  std::string name;
  Eigen::VectorXd values;  ///< V; not a number: not known, and left out of means
};

/// One parcellation of a patch's vertices; keys that `names` lacks are no region.
struct PatchRegions {
  VertexKeys keys;  ///< V
  std::map<Label, std::string> names;
};

/// One line for the whole patch and one for each region that has a vertex, parcellation after
/// parcellation, as tab-separated text with a header: region, vertices, faces, area on the
/// reference and in the map (mm^2), and for each map mean and standard deviation, weighted by the
/// vertices' areas on the reference.
///
/// A face belongs to a region if its three vertices do.
[[nodiscard]] std::string patchTable(const TriangleMesh& reference, const Positions& flat,
                                     const std::vector<PatchRegions>& regions,
                                     const std::vector<PatchMap>& maps);

/// The line between regions: one piece in each face whose vertices differ (three where all do).
/// On an oriented surface seen from outside, sides[0] lies left of the way from `from` to `to`.
struct OutlinePiece {
  Point from, to;
  std::array<Label, 2> sides;
};
[[nodiscard]] std::vector<OutlinePiece> outlines(const Faces& faces, const Positions& positions,
                                                 const VertexKeys& regions);

/// Where to write each region's name: its vertex farthest from its outline, about, by rings.
[[nodiscard]] std::map<Label, Point> regionPlaces(const TriangleMesh& mesh,
                                                  const VertexKeys& regions);

}  // namespace explica::flattening
