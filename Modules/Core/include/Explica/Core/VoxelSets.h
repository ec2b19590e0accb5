// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"

#include <cstdint>
#include <vector>

namespace explica {

using VoxelSet = Volume<std::uint8_t>;  ///< nonzero: in the set

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
