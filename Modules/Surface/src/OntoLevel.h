// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"
#include "Explica/Surface/LevelSet.h"

namespace explica::surface {

/// Farthest that a sliding vertex is brought back to the border of the tissue in one sweep, voxels.
inline constexpr double kNearBorder = 0.5;

/// Squared change of a level per voxel below which there is nothing to follow.
inline constexpr double kFlatLevel = 1e-8;

/// Nearest zero of a level set along its gradient; `from` itself if that is farther than `most`,
/// mm, if the level is flat or if the surface there faces the other way than `normal`.
[[nodiscard]] Point ontoLevel(const LevelSet& level, const Point& from, const Vector& normal,
                              double most);

}  // namespace explica::surface
