// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Patch.h"

#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Unfolding/Unfolder.h"

namespace explica::unfolding {

/// What an unfolding works on, as it stands before anything moves.
struct PatchSetup {
  TriangleMesh mesh;                  ///< reference positions; faces that move or stand in the way
  Region region;                      ///< faces are rows of mesh.faces
  geometry::MeshTopology topology;    ///< of mesh
  std::vector<std::int32_t> moving;   ///< vertices that move, ascending
  std::vector<std::int32_t> unknown;  ///< V: row of the system, or -1
  double edge = 0;                    ///< mean edge length of the region, mm
  double area = 0;                    ///< of the region, mm^2
  double collarWidth = 0;             ///< of an elastic collar, mm along the surface
  std::vector<std::int32_t> collar;   ///< faces outside the region with a vertex that moves
  Patch patch;
  Couplings couplings;  ///< of the unknowns that share an edge
};

/// Flags, true at the places that are listed.
[[nodiscard]] inline std::vector<bool> markedOf(Eigen::Index count,
                                                const std::vector<std::int32_t>& marked) {
  std::vector<bool> result(static_cast<std::size_t>(count), false);
  for (const std::int32_t i : marked) result[i] = true;
  return result;
}

/// Lists what moves and what it keeps.
/// @throws InvalidInput  an option out of range, no face, or a face of zero area in the region
[[nodiscard]] PatchSetup setUpPatch(TriangleMesh mesh, Region region,
                                    const visibility::Viewpoints& viewpoints,
                                    const UnfolderOptions& options);

}  // namespace explica::unfolding
