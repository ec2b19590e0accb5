// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Surface/CorticalSurface.h"
#include "Explica/Surface/CorticalTissue.h"

namespace explica::surface {

/// Inner, middle and outer surface of tissue that runs out of the image: a block, a slab, a rim.
///
/// The sheet is where the harmonic interpolant is one half, so that it has the topology of the
/// tissue itself (no sphere is asked) and ends in rims where the tissue does: on the image's edge,
/// and where it meets what is neither inside nor outside.  Pockets within the tissue, pieces and
/// holes that are small beside its thickness are closed or left out, and counted.  From the
/// remeshed sheet both other surfaces grow along the trajectories to the inner and the outer
/// boundary, and the middle one lies half way between them; vertex i of one corresponds to vertex i
/// of the others, and no surface meets itself, as with buildSurfaces().  The interpolant is solved
/// as if the tissue ended at the image's edge at a right angle: vertices whose thickness this can
/// change (nearer to that edge than 1.25 times their thickness) are marked in `sheet.known`.
///
/// Curvature is that of the inner surface; depth below a hull is not defined and left empty.
/// @throws InvalidInput  no tissue between inner and outer region, or an option out of range
/// Does not depend on the number of threads.
[[nodiscard]] CorticalSurfaces buildSheets(const TissueMasks& masks,
                                           const SurfaceOptions& options = {},
                                           const Monitor& monitor = {});

}  // namespace explica::surface
