// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Patch.h"

#include "Explica/Unfolding/Region.h"

namespace explica::unfolding {

/// A flat map of the region that folds nowhere, made on few of its vertices, the others put between
/// them (see Flattening): where parts go matters here, not how each face lies.
/// @param mesh  at rest
/// @return without vertices where the region is not one piece with a rim, or has handles, or is
///         looked at from all sides
[[nodiscard]] PatchGuide makeGuide(const TriangleMesh& mesh, const Region& region,
                                   const PatchRoom& room);

/// Turns and shifts a guide's map across the room's axis so that it lies nearest to the region.
/// @param mesh  at rest
void layGuide(const TriangleMesh& mesh, const PatchRoom& room, PatchGuide& guide);

}  // namespace explica::unfolding
