// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Parallel.h"
#include "MultigridHierarchy.h"

namespace explica::harmonic {

namespace {

constexpr std::size_t kGrain = 1 << 13;  // elements a task
constexpr int kCoarsestSweeps = 20;  // smoothings that stand for a solution on the coarsest grid

}  // namespace

void MultigridHierarchy::smoothCoarse(MultigridLevel& l, bool fromZero) const {
  for (int colour = 0; colour < 2; ++colour) {
    const std::int32_t begin = colour == 0 ? 0 : l.red, end = colour == 0 ? l.red : l.count;
    if (fromZero && colour == 0) {
      parallelFor(end - begin, kGrain, [&, begin](std::size_t k) {
        const std::size_t n = begin + k;
        l.x[n] = l.b[n] * l.inverseDiagonal[n];
      });
      continue;
    }
    parallelFor(end - begin, kGrain, [&, begin](std::size_t k) {
      const std::size_t n = begin + k;
      float sum = l.b[n];
      for (std::int32_t e = l.start[n]; e < l.start[n + 1]; ++e) {
        sum += l.coefficient[e] * l.x[l.column[e]];
      }
      l.x[n] = sum * l.inverseDiagonal[n];
    });
  }
}

void MultigridHierarchy::prolong(int level, std::vector<float>& x) const {
  const MultigridTransfer& t = transfers[level];
  const std::vector<float>& e = coarse[level].x;
  parallelFor(t.aggregate.size(), kGrain, [&](std::size_t n) {
    const auto& toward = t.toward[n];
    x[n] += t.ownWeight * e[t.aggregate[n]] + 0.25F * (e[toward[0]] + e[toward[1]] + e[toward[2]]);
  });
}

void MultigridHierarchy::solve(int level) {
  MultigridLevel& l = coarse[level - 1];
  if (level == static_cast<int>(coarse.size())) {
    smoothCoarse(l, true);
    for (int sweep = 1; sweep < kCoarsestSweeps; ++sweep) smoothCoarse(l, false);
    return;
  }
  smoothCoarse(l, true);
  // After the sweep only even cells have a residual.
  const MultigridTransfer& t = transfers[level];
  MultigridLevel& next = coarse[level];
  parallelFor(next.count, kGrain / 4, [&](std::size_t c) {
    float sum = 0;
    for (std::int32_t s = t.childStart[c]; s < t.childStart[c + 1]; ++s) {
      const std::int32_t n = t.child[s];
      if (n >= l.red) continue;
      float residual = l.b[n] - (l.inverseDiagonal[n] > 0 ? l.x[n] / l.inverseDiagonal[n] : 0);
      for (std::int32_t e = l.start[n]; e < l.start[n + 1]; ++e) {
        residual += l.coefficient[e] * l.x[l.column[e]];
      }
      sum += residual;
    }
    next.b[c] = sum;
  });
  solve(level + 1);
  prolong(level, l.x);
  smoothCoarse(l, false);
}

void MultigridHierarchy::sweep(int colour, const std::vector<float>& r,
                               std::vector<float>& e) const {
  const auto ofStrand = [&](const Strand& strand) {
    const float* from = r.data() + strand.begin;
    combineWithSums(strand, stencil.regular, e, e.data() + strand.begin,
                    [from](std::int32_t k, float sum) { return from[k] + sum; });
  };
  const auto ofIrregular = [&](std::size_t n, std::size_t row) {
    e[n] = r[n] + irregularSum(n, row, e);
  };
  forVoxelsOf(annulus, stencil, colour, ofStrand, ofIrregular);
}

void MultigridHierarchy::restrictEven(const std::vector<float>& r, const std::vector<float>& e) {
  const auto diagonal = static_cast<float>(stencil.regularDiagonal);
  const auto ofStrand = [&](const Strand& strand) {
    const float *from = r.data() + strand.begin, *own = e.data() + strand.begin;
    combineWithSums(strand, stencil.regular, e, evenResidual.data() + strand.begin,
                    [from, own, diagonal](std::int32_t k, float sum) {
                      return diagonal * (from[k] - own[k] + sum);
                    });
  };
  const auto ofIrregular = [&](std::size_t n, std::size_t row) {
    evenResidual[n] =
        stencil.diagonal[row] * stencil.share[row] * (r[n] - e[n] + irregularSum(n, row, e));
  };
  const std::int32_t red = annulus.runEnd[1];
  evenResidual.resize(red);
  forVoxelsOf(annulus, stencil, 0, ofStrand, ofIrregular);
  const MultigridTransfer& t = transfers[0];
  MultigridLevel& next = coarse[0];
  parallelFor(next.count, kGrain / 4, [&](std::size_t c) {
    float sum = 0;
    for (std::int32_t s = t.childStart[c]; s < t.childStart[c + 1]; ++s) {
      if (t.child[s] < red) sum += evenResidual[t.child[s]];
    }
    next.b[c] = sum;
  });
}

void MultigridHierarchy::cycle(const std::vector<float>& r, std::vector<float>& e) {
  parallelFor(annulus.runEnd[1], kGrain, [&](std::size_t n) { e[n] = r[n]; });
  sweep(1, r, e);
  if (!coarse.empty()) {
    restrictEven(r, e);
    solve(1);
    prolong(0, e);
  }
  sweep(0, r, e);
  sweep(1, r, e);
}

Multigrid::Multigrid(const Annulus& annulus)
    : hierarchy_(std::make_unique<MultigridHierarchy>(annulus)) {}
Multigrid::~Multigrid() = default;
Multigrid::Multigrid(Multigrid&&) noexcept = default;
Multigrid& Multigrid::operator=(Multigrid&&) noexcept = default;

void Multigrid::cycle(const std::vector<float>& r, std::vector<float>& e) {
  e.resize(r.size());
  hierarchy_->cycle(r, e);
}

int Multigrid::levels() const {
  return static_cast<int>(hierarchy_->coarse.size()) + 1;
}

}  // namespace explica::harmonic
