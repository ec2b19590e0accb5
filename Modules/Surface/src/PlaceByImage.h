// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Surface/CorticalSurface.h"
#include "GrowingColumns.h"
#include "RibbonPaths.h"

#include <optional>

namespace explica::surface {

/// The same white matter's surface on which an image is asked for the borders: of as many faces as
/// surfaces have unless told otherwise, but with no edges shorter than a voxel.  Nothing where the
/// given one is about as fine.
[[nodiscard]] std::optional<WhiteSurface> whereImageIsAsked(const WhiteSurface& white);

/// Moves the white surface and the tissue's outer border to where an image changes most steeply.
///
/// Where borders are found depends on the mesh: a coarse one cuts off crowns and floors of the
/// folds before the image is asked.  So they are looked for on one and the same, however many faces
/// were asked for; vertices of another surface have them from the nearest point of this one.
/// @param along    the trajectories of the labels' ribbon
/// @param other    whereImageIsAsked(); if there is none, borders are looked for on `result.white`
/// @param columns  tissue in, moved tissue out; paths of the vertices of `result.white` out
/// @param result   its white surface is moved
/// @return the moved white surface on which the borders were looked for
[[nodiscard]] TriangleMesh placeByImage(const BorderImages& images, double fluid,
                                        const RibbonPaths& along, std::optional<WhiteSurface> other,
                                        GrowingColumns& columns, CorticalSurfaces& result);

}  // namespace explica::surface
