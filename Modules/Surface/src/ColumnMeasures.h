// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Correspondence/Correspondence.h"

namespace explica::surface {

/// Thickness of a ribbon's voxels at the vertices of its middle surface, mm: the mean over a disc
/// along the surface with the cross-section of a voxel; NaN where no voxel is near.
[[nodiscard]] Eigen::VectorXd thicknessAtVertices(const harmonic::Annulus& annulus,
                                                  const correspondence::Correspondence& found,
                                                  const TriangleMesh& middle);

/// The part of the tissue's middle surface that is nearest to each vertex.  It is that of the
/// voxels' columns: a mesh whose edges are no shorter than cortex is curved cuts off crowns and
/// floors, where cortex is thicker and thinner than elsewhere.
struct Columns {
  Eigen::VectorXd area;       ///< mm^2
  Eigen::VectorXd thickness;  ///< its mean, mm; 0 without area
};
[[nodiscard]] Columns columnsAround(const harmonic::Annulus& annulus,
                                    const correspondence::Correspondence& found,
                                    const TriangleMesh& middle);

}  // namespace explica::surface
