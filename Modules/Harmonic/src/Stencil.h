// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Harmonic/Annulus.h"

#include <array>
#include <vector>

namespace explica::harmonic {

/// Rows of -Laplace on the tissue, divided by their diagonal: u_n - sum_d w_d u_d = rhs_n with
/// w_d >= 0 and sum over all links (boundary ones included) of w_d = 1.
struct Stencil {
  std::array<float, 3> regular{};  ///< weight of each neighbour along an axis at regular voxels
  double regularDiagonal = 0;      ///< 1/mm^2
  std::vector<std::array<float, 6>> weights;  ///< per irregular voxel, boundary links included
  std::vector<float> diagonal;                ///< per irregular voxel, 1/mm^2
  std::vector<float> share;                   ///< per irregular voxel: volume of its cell in voxels

  explicit Stencil(const Annulus& annulus);
};

/// Calls body(begin, end, irregularOffset or -1) for both runs of one colour (0 even, 1 odd).
template <class Body>
void forRunsOf(const Annulus& annulus, int colour, const Body& body) {
  const auto& e = annulus.runEnd;
  const std::int32_t start = colour == 0 ? 0 : e[1];
  body(start, e[2 * colour], -1);
  body(e[2 * colour], e[2 * colour + 1], colour == 0 ? 0 : e[1] - e[0]);
}

}  // namespace explica::harmonic
