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
  parallelFor(x.size(), kGrain, [&](std::size_t n) {
    float sum = t.ownWeight * e[t.aggregate[n]];
    for (int a = 0; a < 3; ++a) {
      if (t.toward[n][a] >= 0) sum += 0.25F * e[t.toward[n][a]];
    }
    x[n] += sum;
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

void MultigridHierarchy::cycle(const std::vector<float>& r, std::vector<float>& e) {
  const auto& links = annulus.links;
  const auto w = stencil.regular;
  const auto irregularSum = [&](std::size_t n, std::size_t row) {
    float sum = 0;
    for (int d = 0; d < 6; ++d) {
      const std::int32_t m = links[n][d];
      if (m >= 0) sum += stencil.weights[row][d] * e[m];
    }
    return sum;
  };
  const auto regularSum = [&](std::size_t n) {
    const auto& l = links[n];
    return w[0] * (e[l[0]] + e[l[1]]) + w[1] * (e[l[2]] + e[l[3]]) + w[2] * (e[l[4]] + e[l[5]]);
  };
  const auto sweep = [&](int colour) {
    forRunsOf(annulus, colour, [&](std::int32_t begin, std::int32_t end, std::int32_t offset) {
      if (offset < 0) {
        parallelFor(end - begin, kGrain, [&, begin](std::size_t k) {
          e[begin + k] = r[begin + k] + regularSum(begin + k);
        });
      } else {
        parallelFor(end - begin, kGrain, [&, begin, offset](std::size_t k) {
          e[begin + k] = r[begin + k] + irregularSum(begin + k, k + offset);
        });
      }
    });
  };
  const std::int32_t red = annulus.runEnd[1];
  parallelFor(red, kGrain, [&](std::size_t n) { e[n] = r[n]; });
  sweep(1);
  if (!coarse.empty()) {
    const MultigridTransfer& t = transfers[0];
    MultigridLevel& next = coarse[0];
    const auto diagonal = static_cast<float>(stencil.regularDiagonal);
    parallelFor(next.count, kGrain / 4, [&](std::size_t c) {
      float sum = 0;
      for (std::int32_t s = t.childStart[c]; s < t.childStart[c + 1]; ++s) {
        const std::int32_t n = t.child[s];
        if (n >= red) continue;
        const std::int32_t row = annulus.irregular(n);
        if (row < 0) {
          sum += diagonal * (r[n] - e[n] + regularSum(n));
        } else {
          sum += stencil.diagonal[row] * stencil.share[row] * (r[n] - e[n] + irregularSum(n, row));
        }
      }
      next.b[c] = sum;
    });
    solve(1);
    prolong(0, e);
  }
  sweep(0);
  sweep(1);
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

double Multigrid::bytesPerCycle() const {
  // Per sweep: links, right-hand side read, values read and written.
  const MultigridHierarchy& h = *hierarchy_;
  const auto n = static_cast<double>(h.annulus.count());
  double bytes = 0.5 * n * (4 + 4) + 0.5 * n * (24 + 4 + 8 + 4);  // from zero, then odd voxels
  bytes += 0.5 * n * (24 + 8) + n * 4;                            // restriction
  bytes += n * (16 + 8);                                          // prolongation
  bytes += n * (24 + 4 + 8);                                      // last sweep
  bytes += static_cast<double>(h.stencil.weights.size()) * 24 * 2;
  for (std::size_t l = 0; l < h.coarse.size(); ++l) {
    const auto cells = static_cast<double>(h.coarse[l].count);
    const auto links = static_cast<double>(h.coarse[l].column.size());
    bytes += cells * (16 + 12 + 12 + 24) + links * 8 * 2;
  }
  return bytes;
}

}  // namespace explica::harmonic
