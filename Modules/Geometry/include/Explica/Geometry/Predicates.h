// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

namespace explica::geometry {

/// Exact sign of the area of the triangle (a, b, c) in the plane: 1 counter-clockwise, 0 collinear.
/// Decided in floating point where its error bound allows, in exact expansions otherwise
/// [Shewchuk1997].
[[nodiscard]] int orientation(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                              const Eigen::Vector2d& c);

/// Exact sign of det(b - a, c - a, d - a): 1 if d lies on the side of (a, b, c) from which they run
/// counter-clockwise, that is, on the side of (b - a) x (c - a); 0 if coplanar.
[[nodiscard]] int orientation(const Point& a, const Point& b, const Point& c, const Point& d);

}  // namespace explica::geometry
