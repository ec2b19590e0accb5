// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Surface/LevelSet.h"

namespace explica::surface {

/// Edges longer than so many times the aim are split, and none is made [Botsch2004, Sec. 4].
inline constexpr double kLong = 4.0 / 3;

/// A mesh with far fewer triangles, before it is worked on with care.
///
/// Edges much shorter than `edge` are collapsed, shortest first, in regions of memory that are
/// worked on by several threads; each collapse keeps the topology and the shape of its triangles,
/// but does not look for what else is near.  Then all faces are looked through once with exact
/// predicates: where two meet, the vertices that were joined there part again, until none do.
///
/// @param mesh  manifold without self-intersection, neighbours in space being neighbours in memory;
///              rims stay as they are
/// @return a mesh of the same topology without self-intersection, in the order of `mesh`, positions
///         as files store them
/// Deterministic.
[[nodiscard]] TriangleMesh thinned(const TriangleMesh& mesh, const LevelSet& level, double edge);

}  // namespace explica::surface
