// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/Regions.h"

#include <cmath>

namespace explica::surface {
namespace {

Label nearestVoxel(const Volume<Label>& atlas, const Point& world) {
  const Vector at = atlas.grid.toIndex(world);
  const int i = static_cast<int>(std::lround(at[0]));
  const int j = static_cast<int>(std::lround(at[1]));
  const int k = static_cast<int>(std::lround(at[2]));
  return atlas.grid.contains(i, j, k) ? atlas(i, j, k) : 0;
}

}  // namespace

VertexKeys labelsWithin(const Volume<Label>& atlas, const Positions& white, const Positions& pial,
                        const std::function<bool(Label)>& counts) {
  constexpr double kDepths[] = {0.5, 0.25, 0.75, 0, 1};
  VertexKeys keys = VertexKeys::Zero(white.rows());
  for (Eigen::Index v = 0; v < white.rows(); ++v) {
    for (const double depth : kDepths) {
      const Point at = ((1 - depth) * white.row(v) + depth * pial.row(v)).transpose();
      const Label label = nearestVoxel(atlas, at);
      if (label == 0 || !counts(label)) continue;
      keys[v] = label;
      break;
    }
  }
  return keys;
}

}  // namespace explica::surface
