// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Grid.h"

#include <algorithm>

namespace explica {

/// Calls visit(i, j, k) for every voxel of a grid's outermost layer, once.
template <class Visit>
void forOutermost(const Grid& grid, const Visit& visit) {
  const auto& n = grid.size;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      const bool wholeRow = k == 0 || j == 0 || k == n[2] - 1 || j == n[1] - 1;
      for (int i = 0; i < n[0]; i += wholeRow ? 1 : std::max(1, n[0] - 1)) visit(i, j, k);
    }
  }
}

}  // namespace explica
