// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Surface/LevelSet.h"

namespace explica::surface {

/// Mean curvature at vertices, mm^-1: half the cotangent Laplacian's outward part, averaged over
/// neighbours `smoothing` times.  Negative where the surface bulges (gyri, a sphere: -1/R),
/// positive in sulci, as FreeSurfer has it.
[[nodiscard]] Eigen::VectorXd meanCurvature(const TriangleMesh& mesh, int smoothing = 3);

/// Depth of points below the hull of a tissue, mm, >= 0: the hull is the tissue closed by a ball of
/// `radius` mm.
[[nodiscard]] Eigen::VectorXd depthBelowHull(const LevelSet& tissue, const Positions& points,
                                             double radius = 10);

}  // namespace explica::surface
