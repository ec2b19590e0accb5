// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Geometry/SelfIntersection.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace explica::surface {

/// A point as files hold it, in float32 numbers: what is checked must be what is written.
[[nodiscard]] Point asStored(const Point& p);

/// Where vertex v goes, attempt by attempt: the whole way at attempt 0, less far at the next ones.
using Attempts = std::function<Point(std::int32_t v, int attempt)>;

/// Moves vertices all at once and leaves the mesh without self-intersection.
///
/// All go to their first attempt, and all faces are looked through once; where two faces meet, the
/// vertices of both go on to their next attempt, after the last one back to where they were, until
/// none meet (they meet nowhere at the start).  That is a fraction of the work of moving one vertex
/// after another, each past its neighbours.
///
/// @param mesh      without self-intersection; positions are float32 numbers
/// @param search    this mesh's: no one else has moved its vertices since
/// @param vertices  that move, each once
/// @param attempts  number of attempts, > 0
/// @return  per vertex of `vertices`, the attempt that it stands at; `attempts` where it has
/// stayed. Does not depend on the number of threads.
std::vector<std::uint8_t> moveTogether(TriangleMesh& mesh, geometry::SelfIntersectionSearch& search,
                                       const std::vector<std::int32_t>& vertices, int attempts,
                                       const Attempts& to);

}  // namespace explica::surface
