// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/Regions.h"

#include "Explica/Core/VoxelSets.h"

namespace explica::surface {
VertexKeys labelsWithin(const Volume<Label>& atlas, const Positions& white, const Positions& pial,
                        const std::function<bool(Label)>& counts) {
  constexpr double kDepths[] = {0.5, 0.25, 0.75, 0, 1};
  VertexKeys keys = VertexKeys::Zero(white.rows());
  for (Eigen::Index v = 0; v < white.rows(); ++v) {
    for (const double depth : kDepths) {
      const Point at = ((1 - depth) * white.row(v) + depth * pial.row(v)).transpose();
      const std::int64_t voxel = voxelAt(atlas.grid, at);
      if (voxel < 0 || atlas[voxel] == 0 || !counts(atlas[voxel])) continue;
      keys[v] = atlas[voxel];
      break;
    }
  }
  return keys;
}

}  // namespace explica::surface
