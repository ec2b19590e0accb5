// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Parallel.h"
#include "Explica/Harmonic/Annulus.h"

#include <array>
#include <vector>

namespace explica::harmonic {

/// Regular voxels in a row: their numbers, and those of their neighbours in each direction, go up
/// by one from each to the next, so that loops over them need no links and use whole registers.
struct Strand {
  std::int32_t begin = 0, count = 0;
  std::array<std::int32_t, 6> links{};  ///< of the first
};

/// Rows of -Laplace on the tissue, divided by their diagonal: u_n - sum_d w_d u_d = rhs_n with
/// w_d >= 0 and sum over all links (boundary ones included) of w_d = 1.
struct Stencil {
  std::array<float, 3> regular{};  ///< weight of each neighbour along an axis at regular voxels
  double regularDiagonal = 0;      ///< 1/mm^2
  std::vector<std::array<float, 6>> weights;  ///< per irregular voxel, boundary links included
  std::vector<std::array<float, 6>> linked;   ///< the same, but 0 where a link ends
  std::vector<float> diagonal;                ///< per irregular voxel, 1/mm^2
  std::vector<float> share;                   ///< per irregular voxel: volume of its cell in voxels
  std::array<std::vector<Strand>, 2> strands;  ///< all regular voxels, per colour

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

/// Calls body(strand) for all regular voxels of one colour, body(n, row) for all irregular ones.
template <class OfStrand, class OfIrregular>
void forVoxelsOf(const Annulus& annulus, const Stencil& stencil, int colour,
                 const OfStrand& ofStrand, const OfIrregular& ofIrregular) {
  constexpr std::size_t kStrandGrain = 1 << 10, kIrregularGrain = 1 << 13;  // elements a task
  const std::vector<Strand>& strands = stencil.strands[colour];
  parallelFor(strands.size(), kStrandGrain, [&](std::size_t s) { ofStrand(strands[s]); });
  forRunsOf(annulus, colour, [&](std::int32_t begin, std::int32_t end, std::int32_t offset) {
    if (offset < 0) return;
    parallelFor(end - begin, kIrregularGrain,
                [&, begin, offset](std::size_t k) { ofIrregular(begin + k, offset + k); });
  });
}

/// Over a strand, to[k] = combine(k, weighted sum of the neighbours' x).
/// @param to  aliases nothing of what `combine` and the sums read
template <class Combine>
void combineWithSums(const Strand& strand, const std::array<float, 3>& weight,
                     const std::vector<float>& x, float* __restrict to, const Combine& combine) {
  std::array<const float*, 6> at{};
  for (int d = 0; d < 6; ++d) at[d] = x.data() + strand.links[d];
  const auto pair = [&](int a, std::int32_t k) {
    return weight[a] * (at[2 * a][k] + at[2 * a + 1][k]);
  };
  for (std::int32_t k = 0; k < strand.count; ++k) {
    to[k] = combine(k, pair(0, k) + pair(1, k) + pair(2, k));
  }
}

}  // namespace explica::harmonic
