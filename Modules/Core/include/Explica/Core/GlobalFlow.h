// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace explica {

// What global flows share, of polygons (Planar) and of surfaces (Visibility).

inline constexpr double kFarAway = 10;  ///< viewing radius over that of the farthest vertex
inline constexpr double kGone = 1e-2;   ///< share of the mean edge: shorter has shrunk to nothing
inline constexpr double kNothingLeft = 1e-6;  ///< share of the start's measure that counts as none

}  // namespace explica
