// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Patch.h"

#include "Explica/Unfolding/Region.h"
#include "Explica/Visibility/Viewpoints.h"

namespace explica::unfolding {

/// Laid flat, a region needs a disc of its area, which is wider than the hole that it came from; so
/// it has to rise until nothing stands within that disc.
/// @param mesh  at rest
[[nodiscard]] PatchRoom findRoom(const TriangleMesh& mesh, const Region& region,
                                 const visibility::Viewpoints& viewpoints);

/// Height that a place lacks to be where the region has room, mm.
[[nodiscard]] inline double deficitOf(const PatchRoom& room, const Point& place) {
  return std::max(0.0, room.height - room.axis.dot(place));
}

/// Share of the region's area that lies below what stood around it, although it ought to be above.
[[nodiscard]] double sunkShare(const Patch& patch, const Positions& x);

}  // namespace explica::unfolding
