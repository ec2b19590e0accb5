// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Harmonic/Annulus.h"

#include <array>
#include <cstdint>
#include <vector>

namespace explica::correspondence {

/// The surface u = 1/2 as a mesh of quadrilaterals, or a curve of edges in the plane: the dual of
/// the grid's links that it crosses.  A vertex lies in a cell of eight voxel centres (four pixel
/// centres) at the mean of the crossings on the cell's links; each sheet of the surface in a cell
/// has a vertex of its own, so that the mesh is a manifold.
struct HalfwaySurface {
  struct Vertex {
    Vector x = Vector::Zero();  ///< continuous index of the annulus' box
    std::int32_t home = -1;     ///< a tissue voxel beside it
  };
  std::vector<Vertex> vertices;
  /// Per face its corners, counter-clockwise seen from the outer side if i, j, k are right-handed.
  /// In the plane the last two are -1, and the outer side is to the left of the way from the first
  /// to the second if i, j are.
  std::vector<std::array<std::int32_t, 4>> faces;
};

/// @param u  per tissue number
[[nodiscard]] HalfwaySurface halfwaySurface(const harmonic::Annulus& annulus,
                                            const std::vector<double>& u);

}  // namespace explica::correspondence
