// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <array>

namespace explica::visibility {

/// Flux through one face and its derivatives.
struct FaceFlux {
  double flux = 0;  ///< mm^2, in [-area, area]; positive if the face looks at the viewpoint
  std::array<Vector, 3> gradient;  ///< by the corners a, b, c, mm
};

/// Flux of the unit rays from `viewpoint` through the triangle (a, b, c), [Thesis, Eq. 5.27], in
/// closed form.
///
/// With corners relative to the viewpoint, n the outward unit normal and h = a . n, the integrand
/// is -h / r, so that flux = -h * Phi, Phi the potential of a uniformly charged triangle: Phi = sum
/// over edges of t_e ln((r_p + r_q + L) / (r_p + r_q - L)) - |h Omega|. The gradient is that of the
/// flux of F = (x - P)/|x - P| through a moving patch: with div F = 2/r, d flux/da = -(2 n *
/// integral of lambda_a / r dS + sum over edges of integral of lambda_a dl x F). Exact up to
/// round-off, whose relative size grows as (distance / edge length)^2 * 1e-16. Faces of zero area
/// have no flux; theirs is the gradient of the three-point rule.
[[nodiscard]] FaceFlux faceFlux(const Point& a, const Point& b, const Point& c,
                                const Point& viewpoint);

/// The same by the three-point rule of degree 2 with its own exact gradient: relative error about
/// 0.1 * (longest edge / distance)^3 or less, for viewpoints many edges away.
[[nodiscard]] FaceFlux faceFluxFar(const Point& a, const Point& b, const Point& c,
                                   const Point& viewpoint);

}  // namespace explica::visibility
