// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

namespace explica::visibility {

/// Where a smooth region is and how it bends there.
struct SurfacePoint {
  Point position;        ///< mm
  Vector inwardNormal;   ///< unit
  double meanCurvature;  ///< mean of the principal curvatures, 1/mm; 1/R for a sphere of radius R
};

/// Velocity that raises the average visibility of a smooth region fastest, [Thesis, Eq. 5.25]:
///   dS/dt = (2 / A) (H E + 1 / |S - P|) N.
/// The factor 2 is dropped in the thesis, from its Eq. 60 on; it belongs to the gradient, the limit
/// of the discrete gradient over the area at a vertex.
[[nodiscard]] Vector smoothVisibilityVelocity(const SurfacePoint& point, const Point& viewpoint,
                                              double averageVisibility, double area);

}  // namespace explica::visibility
