// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "IntactSlices.h"

namespace explica::ventricle {

bool atBase(const Point& x, const Grid& grid, const LongAxis& axis) {
  return axis.share(x) * axis.length() < 0.25 * grid.spacing[2];
}

std::vector<bool> cutSlices(const std::vector<Slice>& slices, const Grid& grid,
                            const LongAxis& axis) {
  const int towardsBase = grid.direction.col(2).dot(axis.direction) > 0 ? -1 : 1;
  const auto whole = [&](int k) {
    if (k < 0 || k >= static_cast<int>(slices.size())) return true;
    const SliceKind kind = slices[static_cast<std::size_t>(k)].kind;
    return kind == SliceKind::Ring || kind == SliceKind::Empty;
  };
  std::vector<bool> cut;
  for (int k = 0; k < static_cast<int>(slices.size()); ++k) {
    cut.push_back(!whole(k) || !whole(k + towardsBase));
  }
  return cut;
}

std::vector<bool> intactSlices(const std::vector<Slice>& slices, const Volume<Label>& heart,
                               const LongAxis& axis) {
  std::vector<bool> intact(static_cast<std::size_t>(heart.grid.size[2]), true);
  const std::vector<bool> cut = cutSlices(slices, heart.grid, axis);
  for (std::size_t v = 0; v < heart.size(); ++v) {
    if (heart[v] != kCavity && heart[v] != kWall) continue;
    const auto s = heart.grid.subscripts(v);
    const auto k = static_cast<std::size_t>(s[2]);
    if (cut[k] && atBase(centreOf(heart.grid, v), heart.grid, axis)) {
      intact[k] = false;
    }
  }
  return intact;
}

}  // namespace explica::ventricle
