// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <cstdint>
#include <numeric>
#include <vector>

namespace explica {

/// A triangulated surface: vertex positions and faces that index them.
///
/// Faces run counter-clockwise seen from outside, so that (b - a) x (c - a) points outward.
/// Nothing here checks that the surface is closed or manifold: see Geometry/MeshTopology.h.
struct TriangleMesh {
  Positions positions;  ///< V x 3, RAS mm
  Faces faces;          ///< F x 3, 0-based vertex indices

  [[nodiscard]] Eigen::Index vertexCount() const { return positions.rows(); }
  [[nodiscard]] Eigen::Index faceCount() const { return faces.rows(); }
  [[nodiscard]] Point corner(Eigen::Index face, int k) const {
    return positions.row(faces(face, k)).transpose();
  }
  /// The number of every face, in order.
  [[nodiscard]] std::vector<std::int32_t> allFaces() const {
    std::vector<std::int32_t> all(static_cast<std::size_t>(faceCount()));
    std::iota(all.begin(), all.end(), 0);
    return all;
  }
};

}  // namespace explica
