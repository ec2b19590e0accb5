// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Harmonic/Interpolant.h"
#include "Stencil.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace explica::harmonic {

/// One coarse grid: cells are connected groups of finer ones, coloured by the parity of their
/// block.
struct MultigridLevel {
  std::int32_t count = 0, red = 0;  // cells [0, red) are even
  std::vector<std::array<std::int32_t, 3>> block;
  std::vector<std::int32_t> start, column;  // links, row by row
  std::vector<std::uint8_t> axis;
  std::vector<float> coefficient, inverseDiagonal;
  std::vector<std::array<float, 3>> boundaryFaces, boundaryConductance;  // per axis
  std::vector<float> x, b;  // x has one element more, which is 0
};

/// How a level is joined to the next coarser one.
struct MultigridTransfer {
  std::vector<std::int32_t> aggregate;              // finer -> coarser
  std::vector<std::array<std::int32_t, 3>> toward;  // coarser cell beside, per axis; at a boundary
                                                    // the one after the last, whose x is 0
  std::vector<std::int32_t> childStart, child;      // coarser -> finer
  std::array<bool, 3> coarsened{};
  float ownWeight = 1;
};

struct MultigridHierarchy {
  explicit MultigridHierarchy(const Annulus& a) : annulus(a), stencil(a) { build(); }

  const Annulus& annulus;
  Stencil stencil;
  std::vector<MultigridLevel> coarse;        // coarse[l] is level l + 1
  std::vector<MultigridTransfer> transfers;  // transfers[l] joins level l and l + 1
  std::vector<float> evenResidual;           // of the finest level's even voxels
  std::vector<std::array<double, 3>> spacing;

  [[nodiscard]] std::int32_t countOf(int level) const {
    return level == 0 ? static_cast<std::int32_t>(annulus.count()) : coarse[level - 1].count;
  }
  [[nodiscard]] std::array<std::int32_t, 3> blockOf(int level, std::int32_t n) const {
    return level == 0 ? annulus.boxSubscripts(n) : coarse[level - 1].block[n];
  }
  /// f(other, axis, conductance): conductance of the shared faces, in faces / mm^2 over distance in
  /// finest voxels.
  template <class F>
  void forEachLink(int level, std::int32_t n, const F& f) const {
    if (level == 0) {
      for (int d = 0; d < 6; ++d) {
        const std::int32_t m = annulus.links[n][d];
        if (m >= 0) f(m, axisOf(d), unit[axisOf(d)]);
      }
      return;
    }
    const MultigridLevel& l = coarse[level - 1];
    for (std::int32_t e = l.start[n]; e < l.start[n + 1]; ++e) {
      f(l.column[e], static_cast<int>(l.axis[e]), l.coefficient[e]);
    }
  }

  std::array<float, 3> unit{};  // 1 / spacing^2

  void build();
  /// Adds the level coarser than `level`, halving the axes that are marked.
  /// \param extent cell size of `level` in finest voxels
  void coarsen(int level, const std::array<bool, 3>& coarsened, const std::array<float, 3>& extent);
  void solve(int level);  // level >= 1
  void cycle(const std::vector<float>& r, std::vector<float>& e);
  /// One colour of a red-black Gauss-Seidel sweep on the finest level.
  void sweep(int colour, const std::vector<float>& r, std::vector<float>& e) const;
  /// Right-hand side of level 1, when odd voxels have no residual.
  void restrictEven(const std::vector<float>& r, const std::vector<float>& e);
  [[nodiscard]] float irregularSum(std::size_t n, std::size_t row,
                                   const std::vector<float>& e) const {
    const auto& links = annulus.links[n];
    const auto& weights = stencil.linked[row];
    float sum = 0;
    // Without weight any voxel serves that no other thread writes, so its own; a branch would cost
    // more, as no processor foresees the answer.
    const auto own = static_cast<std::int32_t>(n);
    for (int d = 0; d < 6; ++d) sum += weights[d] * e[links[d] < 0 ? own : links[d]];
    return sum;
  }
  void smoothCoarse(MultigridLevel& l, bool fromZero) const;
  void prolong(int level, std::vector<float>& x) const;
};

}  // namespace explica::harmonic
