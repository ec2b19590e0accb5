// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Geometry/MeshTopology.h"

#include <span>

namespace explica::geometry {

/// Distance along the surface from the nearest of `sources` to every vertex, mm; infinity where
/// there is no way, or beyond `limit`.
///
/// Front propagation over triangles: from the distances at an edge the source is unfolded into the
/// plane of the next triangle, so distances are exact on flat and developable parts without saddle
/// points in the way, and converge on curved ones; never below the straight-line distance.
/// Vertices are corrected until nothing changes, so obtuse triangles need no special care.
/// O(V log V) in practice.  Deterministic.
///
/// @param topology  of the same mesh (Geometry/MeshTopology.h)
/// @throws InvalidInput  a source is no vertex, or there is none
[[nodiscard]] Eigen::VectorXd geodesicDistances(const TriangleMesh& mesh,
                                                const MeshTopology& topology,
                                                std::span<const std::int32_t> sources,
                                                double limit = kInfinity);

}  // namespace explica::geometry
