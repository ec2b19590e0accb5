// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Flattening/Disc.h"

#include <span>
#include <vector>

namespace explica::flattening {

/// The faces of a hemisphere without its medial wall.
///
/// The wall is the largest connected part of the faces with a vertex off the cortex, and what it
/// encloses; smaller parts are taken for cortex, so that the surface gets one opening.
/// @param inCortex  one a vertex
/// @throws InvalidInput  no vertex, or every vertex, is in the cortex
[[nodiscard]] std::vector<std::int32_t> facesWithoutWall(const TriangleMesh& mesh,
                                                         const std::vector<bool>& inCortex);

/// Vertices along a cut, neighbours by edges: from the rim, or an earlier cut, inwards.
using CutPath = std::vector<std::int32_t>;

/// Gives the sides of cuts vertices of their own: faces on all sides of a vertex but the first name
/// a copy of it.
/// @return the vertex of which each copy is one; copies are numbered on from `vertexCount`
/// @throws InvalidInput  a step of a path that is no edge
[[nodiscard]] std::vector<std::int32_t> openFaces(Faces& faces, Eigen::Index vertexCount,
                                                  std::span<const CutPath> cuts);

/// A disc opened along paths: faces stay, and a vertex on a path becomes as many as there are sides
/// to it.  The first of them keeps its number, the others come last.  `vertexOrigin` names the
/// vertex of the whole for each of them.
///
/// @param cuts  in the disc's numbers
/// @throws InvalidInput  a step of a path that is no edge, or paths that take the disc apart
[[nodiscard]] Disc openedAlong(const Disc& disc, std::span<const CutPath> cuts);

/// For each vertex of the disc: it has the same origin as an earlier one.
[[nodiscard]] std::vector<bool> secondCopies(const Disc& disc);

}  // namespace explica::flattening
