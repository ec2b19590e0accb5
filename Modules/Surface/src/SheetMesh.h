// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace explica::surface {

/// The mesh without the marked faces, and without vertices that no face is left at.
[[nodiscard]] TriangleMesh withoutFaces(const TriangleMesh& mesh,
                                        const std::vector<std::uint8_t>& marked);

/// A manifold out of faces whose edges have one or two faces: where several fans meet at a vertex,
/// the largest stays; faces that hang on by one edge go.
[[nodiscard]] TriangleMesh withoutPinches(const TriangleMesh& mesh);

/// The pieces whose area is at least `least`, mm^2, and the largest one.
/// @return with how many pieces were left out
struct Pieces {
  TriangleMesh mesh;
  std::int64_t leftOut = 0;
};
[[nodiscard]] Pieces largePieces(const TriangleMesh& mesh, double least);

/// Marked faces, but those of patches, joined by edges, whose area is below `least`, mm^2.
[[nodiscard]] std::vector<std::uint8_t> largePatches(const TriangleMesh& mesh,
                                                     std::vector<std::uint8_t> marked,
                                                     double least);

/// Closes the rims that are shorter than `longest`, mm, by a fan about a new vertex in their
/// middle, unless its faces would meet others.
/// @param keep  true for a rim that is not to be closed
struct Closed {
  TriangleMesh mesh;
  std::int64_t holes = 0;
};
[[nodiscard]] Closed withHolesClosed(
    const TriangleMesh& mesh, double longest,
    const std::function<bool(const std::vector<std::int32_t>&)>& keep);

}  // namespace explica::surface
