// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Surface/CorticalSurface.h"
#include "GrowingColumns.h"
#include "RibbonPaths.h"

#include <optional>

namespace explica::surface {

/// The same white matter's surface with edges of a voxel, where the given one's are much longer or
/// shorter.
[[nodiscard]] std::optional<WhiteSurface> withEdgesOfVoxels(const WhiteSurface& white);

/// Moves the white surface and the tissue's outer border to where an image changes most steeply.
///
/// Borders are looked for on a white surface whose edges are about as long as voxels: on a coarser
/// one crowns and floors of the folds are cut off before the image is asked, on a finer one
/// neighbours see the same voxels.  So what the image says does not depend on how many faces were
/// asked for; vertices of another surface have it from the nearest point of this one.
/// @param along    the trajectories of the labels' ribbon
/// @param other    withEdgesOfVoxels(); if there is none, borders are looked for on `result.white`
/// @param columns  tissue in, moved tissue out; paths of the vertices of `result.white` out
/// @param result   its white surface is moved
/// @return the moved white surface on which the borders were looked for
[[nodiscard]] TriangleMesh placeByImage(const BorderImages& images, double fluid,
                                        const RibbonPaths& along, std::optional<WhiteSurface> other,
                                        GrowingColumns& columns, CorticalSurfaces& result);

}  // namespace explica::surface
