// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/Curve.h"

namespace explica::planar {

/// Ascent direction of the average visibility of a differentiable contour, [Thesis, Eq. 4.9]:
///
///     C_t = (1/L) (kappa E + 1/|C - P|) N,    C_ss = kappa N, N the inward unit normal.
///
/// The limit of the polygon's gradient per unit length.  Well-posed only while E > 0.
/// @return 1/mm per mm of contour: the rate of E for a unit displacement of a unit length
[[nodiscard]] Point2 continuousFlow(const Point2& point, const Point2& inwardNormal,
                                    double curvature, double average, double length,
                                    const Point2& viewpoint);

}  // namespace explica::planar
