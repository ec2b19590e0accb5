// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Surface/CorticalSurface.h"

#include <optional>

namespace explica::surface {

/// Thickness between two surfaces as FreeSurfer defines it: at each vertex the mean of the shortest
/// way from the white vertex to the pial surface and from the pial vertex to the white surface
/// [FischlDale2000], mm.  Not capped.  0 where the two vertices coincide (medial wall).
[[nodiscard]] Eigen::VectorXd distanceThickness(const TriangleMesh& white,
                                                const TriangleMesh& pial);

/// Takes over surfaces that another program made: positions and faces stay as they are, the middle
/// surface (half way on the straight line, if none is given), thickness, curvature and
/// sulcal depth are added.  What only our own extraction knows (defects, times) stays empty.
/// @throws InvalidInput  the surfaces have different faces
[[nodiscard]] CorticalSurfaces adoptSurfaces(TriangleMesh white, TriangleMesh pial,
                                             std::optional<TriangleMesh> mid = {});

}  // namespace explica::surface
