// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Geometry/SelfIntersection.h"
#include "Explica/Unfolding/Unfold.h"

#include <span>
#include <vector>

namespace explica::unfolding {

/// Who crosses whom after an unfolding, by the exact test.
struct CrossingAccount {
  std::vector<geometry::FacePair> after;  ///< pairs of the unfolded surface, sorted
  std::size_t added = 0;                  ///< of them that did not cross at the start
  std::size_t withRest = 0;  ///< pairs of a face that moved and one of the surface it came from
};

/// Compares an unfolded surface with the one that it came from.
/// @param original  all faces, before
/// @param region    of `original`
/// @param result    whose mesh counts as it is, rounded or not
/// @param before    pairs of `original`, sorted
[[nodiscard]] CrossingAccount countCrossings(const TriangleMesh& original, const Region& region,
                                             const UnfoldResult& result,
                                             std::span<const geometry::FacePair> before);

}  // namespace explica::unfolding
