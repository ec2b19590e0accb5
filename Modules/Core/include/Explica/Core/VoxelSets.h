// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Parallel.h"
#include "Explica/Core/Volume.h"

#include <cstdint>
#include <vector>

namespace explica {

using VoxelSet = Volume<std::uint8_t>;  ///< nonzero: in the set

/// The voxels that a test accepts, as 1; asked on several threads.
template <class Test>
[[nodiscard]] VoxelSet setWhere(const Grid& grid, const Test& test) {
  VoxelSet set(grid, 0);
  parallelFor(set.size(), 65536, [&](std::size_t v) { set[v] = test(v) ? 1 : 0; });
  return set;
}

[[nodiscard]] std::int64_t voxelsIn(const VoxelSet& set);

/// Centre of a voxel, RAS mm.
[[nodiscard]] inline Point centreOf(const Grid& grid, std::size_t voxel) {
  const auto [i, j, k] = grid.subscripts(voxel);
  return grid.toWorld(Vector(i, j, k));
}

/// The voxel whose centre is nearest to a place; -1 beyond the grid.
[[nodiscard]] std::int64_t voxelAt(const Grid& grid, const Point& place);

/// Squared distance of each voxel's centre to the nearest voxel centre of the set, mm^2; infinite
/// if the set is empty.  Exact; separable lower envelopes of parabolas [Felzenszwalb2012], threaded
/// over lines.
[[nodiscard]] Volume<float> squaredDistanceTo(const VoxelSet& set);

/// Face-connected components: number from 0 for each voxel of the set, -1 elsewhere.
struct Components {
  Volume<std::int32_t> number;
  std::vector<std::int64_t> size;              ///< voxels of each component
  [[nodiscard]] std::int32_t largest() const;  ///< -1 if there is none
};
[[nodiscard]] Components componentsOf(const VoxelSet& set);

/// Waves from labelled voxels through a set, one label each, nearest first.
/// @param labels  nonzero where a wave starts, in the set or beside it; takes those that arrive
/// @return way of each voxel to the nearest start, mm along the steps to the 26 neighbours;
///         infinite where none arrives
Volume<float> spreadLabels(const VoxelSet& through, VoxelSet& labels);

}  // namespace explica
