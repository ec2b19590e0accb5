// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Correspondence/Correspondence.h"
#include "Explica/Surface/CorticalSurface.h"

namespace explica::surface {

/// Thickness of a ribbon's voxels at the vertices of its middle surface, mm: the mean over a disc
/// along the surface with the cross-section of a voxel; NaN where no voxel is near.
[[nodiscard]] Eigen::VectorXd thicknessAtVertices(const harmonic::Annulus& annulus,
                                                  const correspondence::Correspondence& found,
                                                  const TriangleMesh& middle);

/// A column for each voxel of known thickness, with the voxel's share of its cross-section.
/// @param leftOut  1 at voxels without one; empty: none
[[nodiscard]] Columns columnsOf(const harmonic::Annulus& annulus,
                                const correspondence::Correspondence& found,
                                const std::vector<std::uint8_t>& leftOut = {});

}  // namespace explica::surface
