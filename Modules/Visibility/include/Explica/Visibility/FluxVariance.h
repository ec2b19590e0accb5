// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Visibility/Viewpoints.h"

#include <cstdint>
#include <vector>

namespace explica::visibility {

/// Variance of the flux over the listed faces, which [Thesis, section 4.2.4] reports beside the
/// average E of its polygons: (1 / A) integral of f^2 dS - E^2, f = (x - P) . N / |x - P|, in
/// [0, 1].  0 where every ray meets the surface under one angle.
///
/// By the seven-point rule of degree 5 on faces divided until they are an eighth as long as their
/// distance from the viewpoint: relative error below 1e-6.  Of several viewpoints the weighted
/// mean: the variance is that within the views, not between them.
/// @throws InvalidInput  no face, no area, or no viewpoint
[[nodiscard]] double fluxVariance(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces,
                                  const Viewpoints& viewpoints);

}  // namespace explica::visibility
