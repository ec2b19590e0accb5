// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Stencil.h"

namespace explica::harmonic {

namespace {

/// Strands of the regular voxels [begin, end).
std::vector<Strand> strandsOf(const Annulus& annulus, std::int32_t begin, std::int32_t end) {
  constexpr std::size_t kStrandVoxels = 1 << 14;  // a task; a strand ends with its task's voxels
  const auto follows = [&](std::int32_t n) {
    bool next = true;
    for (int d = 0; d < 6; ++d) next &= annulus.links[n][d] == annulus.links[n - 1][d] + 1;
    return next;
  };
  const std::size_t count = end - begin;
  std::vector<std::vector<Strand>> parts((count + kStrandVoxels - 1) / kStrandVoxels);
  parallelForBlocks(count, kStrandVoxels, [&](std::size_t first, std::size_t last) {
    std::vector<Strand>& part = parts[first / kStrandVoxels];
    for (std::size_t k = first; k < last; ++k) {
      const auto n = static_cast<std::int32_t>(begin + k);
      if (k == first || !follows(n)) part.push_back({n, 0, annulus.links[n]});
      ++part.back().count;
    }
  });
  std::vector<Strand> strands;
  for (const auto& part : parts) strands.insert(strands.end(), part.begin(), part.end());
  return strands;
}

}  // namespace

Stencil::Stencil(const Annulus& annulus) {
  std::array<double, 3> inverseSquare{};
  for (int a = 0; a < 3; ++a) {
    inverseSquare[a] = 1 / (annulus.grid.spacing[a] * annulus.grid.spacing[a]);
  }
  // In a plane every voxel is insulated along k, hence irregular; this serves 3D alone.
  regularDiagonal = 2 * (inverseSquare[0] + inverseSquare[1] + inverseSquare[2]);
  for (int a = 0; a < 3; ++a) regular[a] = static_cast<float>(inverseSquare[a] / regularDiagonal);

  weights.resize(annulus.fractions.size());
  linked.resize(annulus.fractions.size());
  diagonal.resize(annulus.fractions.size());
  share.resize(annulus.fractions.size());
  for (int colour = 0; colour < 2; ++colour) {
    forRunsOf(annulus, colour, [&](std::int32_t begin, std::int32_t end, std::int32_t offset) {
      if (offset < 0) {
        strands[colour] = strandsOf(annulus, begin, end);
        return;
      }
      parallelFor(end - begin, 4096, [&, begin, offset](std::size_t k) {
        const std::size_t row = k + offset;
        const auto& links = annulus.links[begin + k];
        const auto& fractions = annulus.fractions[row];
        std::array<double, 6> coefficient{};
        double sum = 0, cell = 1;
        for (int a = 0; a < 3; ++a) {
          const double left = fractions[2 * a], right = fractions[2 * a + 1];
          cell *= 0.5 * (left + right);
          for (int side = 0; side < 2; ++side) {
            const int d = 2 * a + side;
            if (links[d] == kInsulated) continue;
            // [ShortleyWeller1938]: 2 / (h_d (h_left + h_right)).
            coefficient[d] = 2 * inverseSquare[a] / (fractions[d] * (left + right));
            sum += coefficient[d];
          }
        }
        for (int d = 0; d < 6; ++d) {
          weights[row][d] = static_cast<float>(coefficient[d] / sum);
          linked[row][d] = links[d] < 0 ? 0 : weights[row][d];
        }
        diagonal[row] = static_cast<float>(sum);
        share[row] = static_cast<float>(cell);
      });
    });
  }
}

}  // namespace explica::harmonic
