// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <vector>

namespace explica::flattening {

/// How deep each vertex lies in the folds, V, without unit: positive in sulci, 0 in the mean and 1
/// in the standard deviation over the surface's area.
///
/// It is the way along the outward normal to the smoothed surface x - t Laplace(x) = x0.  t is a
/// 700th of the area, so that folds as wide as a 27th of the surface's extent vanish: 10 mm for a
/// human hemisphere.
/// @throws InvalidInput  the surface has no area
[[nodiscard]] Eigen::VectorXd foldDepth(const TriangleMesh& mesh);

/// The widest level place of a surface: the vertices about that where normals, smoothed as in
/// foldDepth(), agree best, one added after the other by this measure until they make up a share
/// of the area.  On a hemisphere of the brain that is the medial wall, or most of it.
/// @throws InvalidInput  the surface has no area
[[nodiscard]] std::vector<bool> flattestPlace(const TriangleMesh& mesh, double areaShare = 0.025);

}  // namespace explica::flattening
