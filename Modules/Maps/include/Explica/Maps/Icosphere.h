// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <optional>
#include <string_view>

namespace explica::maps {

/// fsaverage's sphere: the icosahedron divided `level` times, radius 100 mm, vertices and faces in
/// fsaverage's order, so that each level's vertices are the first of the next one's.  Coordinates
/// of the unit sphere have four decimals before they are put on the sphere, as in FreeSurfer's own;
/// 0.2 % of them differ from it in the last of the four.
/// @param level  0 ... 7; 7 is fsaverage, 163,842 vertices
[[nodiscard]] TriangleMesh fsaverageSphere(int level);

/// Level of "fsaverage3" ... "fsaverage6", "fsaverage"; nothing for another name.
[[nodiscard]] std::optional<int> fsaverageLevel(std::string_view name);

}  // namespace explica::maps
