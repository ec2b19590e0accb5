// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <span>
#include <vector>

namespace explica::sampling {

/// Where points lie next to a surface, to carry its values over to them.
struct NearestOnSurface {
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3> corners;  ///< P x 3, vertices of the nearest face
  Eigen::MatrixX3d weights;  ///< P x 3, barycentric, of the nearest point
  Eigen::VectorXd distance;  ///< P, mm
};

/// The nearest points of a surface of the same subject that another program has made.
/// @throws InvalidInput  a surface without faces, a point that is not finite
[[nodiscard]] NearestOnSurface nearestOn(const TriangleMesh& surface, const Positions& points);

/// Values of the surface's vertices at the points: linear on its faces; corners that hold NaN are
/// left out while at least half of the weight is left, else NaN.
/// @param values  one a vertex of the surface
[[nodiscard]] Eigen::VectorXd carryOver(const NearestOnSurface& nearest,
                                        const Eigen::VectorXd& values);

}  // namespace explica::sampling
