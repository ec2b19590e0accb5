// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/ContinuousFlow.h"

namespace explica::planar {

Point2 continuousFlow(const Point2& point, const Point2& inwardNormal, double curvature,
                      double average, double length, const Point2& viewpoint) {
  return (curvature * average + 1 / (point - viewpoint).norm()) / length * inwardNormal;
}

}  // namespace explica::planar
