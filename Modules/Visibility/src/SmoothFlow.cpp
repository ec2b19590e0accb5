// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/SmoothFlow.h"

namespace explica::visibility {

Vector smoothVisibilityVelocity(const SurfacePoint& point, const Point& viewpoint,
                                double averageVisibility, double area) {
  const double bracket =
      point.meanCurvature * averageVisibility + 1 / (point.position - viewpoint).norm();
  return 2 / area * bracket * point.inwardNormal;
}

}  // namespace explica::visibility
