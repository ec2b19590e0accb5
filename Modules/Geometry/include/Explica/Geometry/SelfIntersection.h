// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Geometry/BoundsPyramid.h"

#include <array>
#include <cstdint>
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

/// Looks through one mesh again and again while its vertices move.  Where most faces lie is known
/// from an earlier look, so that a look after few of them have moved costs little more than these.
class SelfIntersectionSearch {
 public:
  /// @param mesh   the same at every look but for where its vertices are
  /// @param moved  faces that have moved since the last look, each once; any the first time
  /// @return pairs with at least one of these, sorted
  [[nodiscard]] std::vector<FacePair> find(const TriangleMesh& mesh,
                                           const std::vector<std::int32_t>& moved);

 private:
  void sortFaces(const TriangleMesh& mesh);

  Point origin_ = Point::Zero();
  std::vector<std::int32_t> faces_;
  BoundsPyramid sorted_;              ///< of all faces, as they lay once
  std::vector<std::int32_t> astray_;  ///< that have moved since
  std::vector<std::uint8_t> isAstray_, isMoved_;
};

}  // namespace explica::geometry
