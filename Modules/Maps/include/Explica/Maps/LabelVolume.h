// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Core/Volume.h"
#include "Explica/Maps/Resampling.h"

namespace explica::maps {

/// Labels of vertices in the voxels between two surfaces: a voxel of which at least half lies
/// between them has the label that holds most of it, others have 0.
///
/// The prism over each face is summed at places less than a quarter of a voxel apart, each with its
/// volume and the label of the corner that it is nearest to; of equal volumes the smaller label
/// wins.
///
/// @param white, pial  same faces, mm, in the grid's world
/// @param keys         V; vertices of key 0 and below fill no voxel
/// @throws InvalidInput  surfaces with different faces, or another number of keys
[[nodiscard]] Volume<Label> labelsBetween(const Grid& grid, const TriangleMesh& white,
                                          const TriangleMesh& pial, const VertexKeys& keys);

/// A grid of cubic voxels along the world's axes that holds the points with two voxels around.
[[nodiscard]] Grid gridAround(const Positions& points, double spacing);

}  // namespace explica::maps
