// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

namespace explica::sampling {

/// Where points lie next to a surface.
struct NearestOnSurface {
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3> corners;  ///< P x 3, vertices of the nearest face
  Eigen::MatrixX3d weights;  ///< P x 3, barycentric, of the nearest point
  Eigen::VectorXd distance;  ///< P, mm
};

/// The nearest points of a surface.
/// @throws InvalidInput  a surface without faces, a point that is not finite
[[nodiscard]] NearestOnSurface nearestOn(const TriangleMesh& surface, const Positions& points);

}  // namespace explica::sampling
