// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <array>
#include <span>
#include <vector>

namespace explica::geometry {

using FacePair = std::array<std::int32_t, 2>;  ///< smaller face first

/// All pairs of faces that meet where a surface may not: apart from a common vertex or edge, or at
/// all if they have none in common.  Exact: the sign of every decision is that of the real numbers.
/// Sorted.  Faces of zero area count as the segments they are.  Threaded; deterministic.
[[nodiscard]] std::vector<FacePair> findSelfIntersections(const TriangleMesh& mesh);

/// As above, for pairs with at least one face marked.
[[nodiscard]] std::vector<FacePair> findSelfIntersections(const TriangleMesh& mesh,
                                                          const std::vector<bool>& faceMarked);

/// All pairs of a surface some faces of which have moved.
/// @param before  pairs until then, sorted
[[nodiscard]] std::vector<FacePair> findSelfIntersections(const TriangleMesh& mesh,
                                                          const std::vector<bool>& faceMoved,
                                                          std::span<const FacePair> before);

}  // namespace explica::geometry
