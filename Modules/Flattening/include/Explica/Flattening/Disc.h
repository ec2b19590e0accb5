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
  std::size_t trimmedFaces = 0;            ///< left out: they hung on the rest by a single vertex
};

/// The listed faces as a disc, holes allowed.
///
/// Where faces hang together by one vertex only, the rim would meet itself there: the smaller of
/// the parts is left out and counted.
/// @throws InvalidInput  no face; no rim; several pieces; handles (no plane can hold them)
[[nodiscard]] Disc discOf(const TriangleMesh& mesh, std::span<const std::int32_t> faces);

/// Finds the rim and the holes of a disc whose mesh is given.
/// @throws InvalidInput  no rim; several pieces; handles
void findLoops(Disc& disc);

/// Boundary loops of an oriented manifold, each in the direction of its faces; the one of the
/// smallest vertex first.
[[nodiscard]] std::vector<Loop> boundaryLoops(const Faces& faces, Eigen::Index vertexCount);

}  // namespace explica::flattening
