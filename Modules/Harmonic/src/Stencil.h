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

/// Weighted sums of the neighbours' x over a strand, each given to put(k, sum).
template <class Put>
void sumNeighbours(const Strand& strand, const std::array<float, 3>& weight, const float* x,
                   const Put& put) {
  const float *a = x + strand.links[0], *b = x + strand.links[1], *c = x + strand.links[2],
              *d = x + strand.links[3], *e = x + strand.links[4], *f = x + strand.links[5];
  const float u = weight[0], v = weight[1], w = weight[2];
#pragma GCC ivdep
  for (std::int32_t k = 0; k < strand.count; ++k) {
    put(k, u * (a[k] + b[k]) + v * (c[k] + d[k]) + w * (e[k] + f[k]));
  }
}

}  // namespace explica::harmonic
