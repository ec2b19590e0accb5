// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Parallel.h"
#include "Explica/Core/VoxelSets.h"
#include "Explica/Segmentation/Hemisphere.h"

#include <algorithm>
#include <string>
#include <string_view>

namespace explica::segmentation {

/// What the atlas says of each voxel.
struct AtlasMap {
  Volume<std::uint8_t> kind;  ///< 0 unlabelled, else 1 + StructureKind
  Volume<std::uint8_t> side;  ///< 1 left, 2 right, 0 otherwise
  Volume<std::uint8_t>
      medialTemporal;   ///< nonzero in structures that border the brain stem's cisterns
  VoxelSet mesialDeep;  ///< hippocampus and amygdala, which no white matter parts from cortex
};

constexpr std::uint8_t kindCode(StructureKind kind) {
  return static_cast<std::uint8_t>(1 + static_cast<int>(kind));
}
constexpr std::uint8_t sideCode(Side side) {
  return static_cast<std::uint8_t>(side);
}

/// As labelVentricles names them.
inline constexpr std::string_view kVentricleName = "Deep_ventricle";

inline bool isVentricle(const std::string& name) {
  return name.compare(0, kVentricleName.size(), kVentricleName) == 0;
}

/// @throws InvalidInput  a label that the legend lacks
[[nodiscard]] AtlasMap mapAtlas(const Volume<Label>& atlas, const AtlasLegend& legend);

/// The brain stem: see extractHemisphere.
[[nodiscard]] VoxelSet findStem(const AtlasMap& map, const AtlasLegend& legend,
                                const Volume<Label>& atlas);

/// Visits the voxels that share a face with one.
template <class Visit>
void forNeighbours(const Grid& grid, std::size_t v, const Visit& visit) {
  for (const std::int64_t w : grid.neighbours(v)) {
    if (w >= 0) visit(static_cast<std::size_t>(w));
  }
}

inline bool touches(const Grid& grid, std::size_t v, const VoxelSet& set) {
  bool found = false;
  forNeighbours(grid, v, [&](std::size_t w) { found = found || set[w] != 0; });
  return found;
}

}  // namespace explica::segmentation
