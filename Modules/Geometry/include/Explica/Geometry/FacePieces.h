// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <functional>
#include <span>
#include <vector>

namespace explica::geometry {

/// The faces about a vertex in fans: lists of those that edges at it join, but for edges to
/// vertices that `isCut` accepts.  In the order of their first faces.
/// @param around  the faces that have the vertex
[[nodiscard]] std::vector<std::vector<std::int32_t>> fansAt(
    const Faces& faces, std::int32_t vertex, std::span<const std::int32_t> around,
    const std::function<bool(std::int32_t)>& isCut = {});

/// Area of each piece, mm^2.
/// @param piece  number of each face's, as facePieces(); negative: the face is of none
[[nodiscard]] std::vector<double> pieceAreas(const TriangleMesh& mesh,
                                             const std::vector<std::int32_t>& piece);

}  // namespace explica::geometry
