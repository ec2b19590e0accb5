// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Visibility/Viewpoints.h"

#include <span>
#include <vector>

namespace explica::visibility {

struct VisibleFractionOptions {
  int subdivision = 3;  ///< rays per face: one to each of subdivision^2 equal sub-triangles
};

/// What is truly seen, by ray casting.
struct VisibleFraction {
  Eigen::VectorXd face;    ///< F, share of each face's area that is seen, in [0, 1]
  Eigen::VectorXd vertex;  ///< V, the same of the area around each vertex; 0 at vertices of no face
  Eigen::VectorXd arriving;  ///< F, flux that arrives over the face's area, in [0, 1]: the seen
                             ///< share times its cosine, the "real" average visibility of [Thesis,
                             ///< figure 4.14]; nothing where nothing is seen
  double total = 0;          ///< share of the whole area, in [0, 1]

  /// Share of the area of the listed faces.
  [[nodiscard]] double of(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces) const;
  /// Mean over the area of the listed faces of what arrives.
  [[nodiscard]] double realOf(const TriangleMesh& mesh,
                              const std::vector<std::int32_t>& faces) const;
  /// Fills `vertex` and `total` by what the faces show.
  void addUp(const TriangleMesh& mesh);
};

/// Share of each face that is seen from the viewpoints: it faces the viewpoint, and no other face
/// lies between.  One ray per sample from the surface to the viewpoint.  Embree in single precision
/// about the mesh's centre, robust traversal; the sample's own face never hides it.  Deterministic.
/// @throws InvalidInput  no face, no viewpoint, a non-finite position, or subdivision outside [1,
/// 64]
[[nodiscard]] VisibleFraction visibleFraction(const TriangleMesh& mesh,
                                              const Viewpoints& viewpoints,
                                              const VisibleFractionOptions& options = {});

/// What is seen once some vertices have moved, by default rays: looks again where the ways from
/// faces to a viewpoint pass by those that moved.  Positions count from the middle of where they
/// stood, so that nothing else changes.
/// @param stood   V x 3, before
/// @param before  what was seen then
/// @throws InvalidInput  as visibleFraction
[[nodiscard]] VisibleFraction visibleFractionAfter(const TriangleMesh& mesh,
                                                   const Viewpoints& viewpoints,
                                                   const Positions& stood,
                                                   const VisibleFraction& before);

/// Share of the area of the listed faces that is seen: visibleFraction(...).of(mesh, faces),
/// without looking at the rest of the surface where it stands nowhere in the way.  For few faces of
/// many.
/// @throws InvalidInput  as visibleFraction
[[nodiscard]] double seenShare(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces,
                               const Viewpoints& viewpoints);

/// How much of each asked face stands over listed ones: the share of three rays from it against
/// `axis` (unit), from points of its middle, that meet a listed face.
/// @throws InvalidInput  no listed face, a non-finite axis, or such a position of a listed face
[[nodiscard]] std::vector<float> standingOver(const Positions& positions, const Faces& faces,
                                              std::span<const std::int32_t> listed,
                                              std::span<const std::int32_t> asked,
                                              const Vector& axis);

}  // namespace explica::visibility
