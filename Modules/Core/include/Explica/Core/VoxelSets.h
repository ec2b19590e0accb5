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

}  // namespace explica
