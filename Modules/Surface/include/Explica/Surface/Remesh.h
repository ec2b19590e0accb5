// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Surface/LevelSet.h"

#include <cstdint>

namespace explica::surface {

/// Below them no shape is kept.
inline constexpr std::int64_t kFewestFaces = 100;

/// Edge of as many equilateral triangles as cover an area, mm.
[[nodiscard]] double edgeFor(double area, std::int64_t faces);

/// How a surface gets triangles of nearly equal shape and size.
struct RemeshOptions {
  std::int64_t faces = 150000;  ///< wanted; met exactly (to the next even number) where
                                ///< possible, but no edge is made shorter than a fifth of a voxel
  int rounds = 5;               ///< of splitting, collapsing, flipping and smoothing
  bool open = false;            ///< the surface may have rims, which stay but for being smoothed
};

/// What a remeshing did.
struct RemeshResult {
  TriangleMesh mesh;
  double edgeLength = 0;  ///< aimed at, mm
};

/// Isotropic remeshing of a level set's surface [Botsch2004]: long edges are split, short ones
/// collapsed, valences evened by flips, vertices centred among their neighbours in the tangent
/// plane and put back on the level set.
///
/// Every step keeps the topology and is refused if it would make the surface intersect itself,
/// judged by exact predicates: so the result has the topology of the input and, as the input,
/// no self-intersection.
///
/// @param mesh   closed (unless `open`) manifold without self-intersection, near the zero of
/// `level`
/// @throws InvalidInput  mesh not closed, or fewer than 100 faces wanted
/// Deterministic.
[[nodiscard]] RemeshResult remesh(const TriangleMesh& mesh, const LevelSet& level,
                                  const RemeshOptions& options = {}, const Monitor& monitor = {});

}  // namespace explica::surface
