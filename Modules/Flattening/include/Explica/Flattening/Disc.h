// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <span>
#include <vector>

namespace explica::flattening {

using Loop = std::vector<std::int32_t>;  ///< vertices along a boundary, in the faces' direction

/// A piece of surface with a rim, on its own vertices: what can be laid flat.
struct Disc {
  TriangleMesh mesh;
  std::vector<std::int32_t> vertexOrigin;  ///< vertex of the whole for each vertex
  std::vector<std::int32_t> faceOrigin;    ///< face of the whole for each face
  Loop rim;                                ///< the longest boundary loop
  std::vector<Loop> holes;                 ///< the other loops
  std::size_t trimmedFaces = 0;            ///< left out: joined to the rest by a single vertex
  std::size_t otherPieces = 0;             ///< left out: all but the largest
  double areaOfOthers = 0;                 ///< share of the area that these have, below one half
};

/// The listed faces as a disc, holes allowed.
///
/// Where faces are joined by one vertex only, the rim would meet itself there: the smaller of the
/// parts is left out and counted.  Of several pieces the one with more than half of the area is
/// taken.
/// @throws InvalidInput  no face; no rim; pieces of which none has half of the area; handles (no
///                       plane can hold them)
[[nodiscard]] Disc discOf(const TriangleMesh& mesh, std::span<const std::int32_t> faces);

/// Finds the rim and the holes of a disc whose mesh is given.
/// @throws InvalidInput  no rim; several pieces; handles
void findLoops(Disc& disc);

}  // namespace explica::flattening
