// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Parallel.h"
#include "Explica/Harmonic/Interpolant.h"
#include "Stencil.h"

#include <algorithm>

namespace explica::harmonic {

namespace {

constexpr std::size_t kGrain = 1 << 13;
constexpr int kCoarsestSize = 60;  // cells; solved by sweeps
constexpr int kCoarsestSweeps = 20;
constexpr int kMaxLevels = 16;
// Axes are coarsened together if their spacings differ by less than this; so smoothing stays good.
constexpr double kNearlyIsotropic = 1.5;

/// One coarse grid: cells are connected groups of finer ones, coloured by the parity of their
/// block.
struct Level {
  std::int32_t count = 0, red = 0;  // cells [0, red) are even
  std::vector<std::array<std::int32_t, 3>> block;
  std::vector<std::int32_t> start, column;  // links, row by row
  std::vector<std::uint8_t> axis;
  std::vector<float> coefficient, inverseDiagonal;
  std::vector<std::array<float, 3>> boundaryFaces, boundaryConductance;  // per axis
  std::vector<float> x, b;
};

/// How a level is joined to the next coarser one.
struct Transfer {
  std::vector<std::int32_t> aggregate;              // finer -> coarser
  std::vector<std::array<std::int32_t, 3>> toward;  // coarser cell beside, per axis; -1: boundary
  std::vector<std::int32_t> childStart, child;      // coarser -> finer
  std::array<bool, 3> coarsened{};
  float ownWeight = 1;
};

}  // namespace

struct Multigrid::Hierarchy {
  explicit Hierarchy(const Annulus& a) : annulus(a), stencil(a) { build(); }

  const Annulus& annulus;
  Stencil stencil;
  std::vector<Level> coarse;        // coarse[l] is level l + 1
  std::vector<Transfer> transfers;  // transfers[l] joins level l and l + 1
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
    const Level& l = coarse[level - 1];
    for (std::int32_t e = l.start[n]; e < l.start[n + 1]; ++e) {
      f(l.column[e], static_cast<int>(l.axis[e]), l.coefficient[e]);
    }
  }

  std::array<float, 3> unit{};  // 1 / spacing^2

  void build();
  void coarsen(int level, const std::array<bool, 3>& coarsened, const std::array<float, 3>& extent);
  void solve(int level);
  void cycle(const std::vector<float>& r, std::vector<float>& e);
  void smoothCoarse(Level& l, bool fromZero) const;
  void prolong(int level, std::vector<float>& x) const;
};

void Multigrid::Hierarchy::build() {
  std::array<double, 3> h{};
  for (int a = 0; a < 3; ++a) {
    h[a] = annulus.grid.spacing[a];
    unit[a] = static_cast<float>(1 / (h[a] * h[a]));
  }
  const int axes = annulus.planar ? 2 : 3;
  std::array<float, 3> extent = {1, 1, 1};  // cell size in finest voxels
  for (int level = 0; level < kMaxLevels && countOf(level) > kCoarsestSize; ++level) {
    double finest = kInfinity;
    for (int a = 0; a < axes; ++a) finest = std::min(finest, h[a]);
    std::array<bool, 3> coarsened{};
    for (int a = 0; a < axes; ++a) coarsened[a] = h[a] < kNearlyIsotropic * finest;
    const std::int32_t before = countOf(level);
    coarsen(level, coarsened, extent);
    for (int a = 0; a < 3; ++a) {
      if (!coarsened[a]) continue;
      h[a] *= 2;
      extent[a] *= 2;
    }
    if (countOf(level + 1) > 0.9 * before) break;
  }
}

void Multigrid::Hierarchy::coarsen(int level, const std::array<bool, 3>& coarsened,
                                   const std::array<float, 3>& extent) {
  const std::int32_t fineCount = countOf(level);
  Transfer t;
  t.coarsened = coarsened;
  std::array<std::int32_t, 3> size{};
  {
    std::array<std::int32_t, 3> top = {0, 0, 0};
    if (level == 0) {
      for (int a = 0; a < 3; ++a) top[a] = annulus.size[a] - 1;
    } else {
      for (const auto& b : coarse[level - 1].block) {
        for (int a = 0; a < 3; ++a) top[a] = std::max(top[a], b[a]);
      }
    }
    for (int a = 0; a < 3; ++a) size[a] = (coarsened[a] ? top[a] / 2 : top[a]) + 1;
  }
  const auto parent = [&](std::array<std::int32_t, 3> b) {
    for (int a = 0; a < 3; ++a) {
      if (coarsened[a]) b[a] >>= 1;
    }
    return b;
  };
  const auto key = [&](const std::array<std::int32_t, 3>& b) {
    return b[0] +
           static_cast<std::size_t>(size[0]) * (b[1] + static_cast<std::size_t>(size[1]) * b[2]);
  };

  // Finer cells, sorted by block (a counting sort).
  const std::size_t blocks = static_cast<std::size_t>(size[0]) * size[1] * size[2];
  std::vector<std::int32_t> blockStart(blocks + 1, 0);
  t.aggregate.resize(fineCount);  // holds the block until the pieces are numbered
  parallelFor(fineCount, kGrain, [&](std::size_t n) {
    t.aggregate[n] =
        static_cast<std::int32_t>(key(parent(blockOf(level, static_cast<std::int32_t>(n)))));
  });
  for (std::int32_t n = 0; n < fineCount; ++n) ++blockStart[t.aggregate[n] + 1];
  for (std::size_t k = 0; k < blocks; ++k) blockStart[k + 1] += blockStart[k];
  std::vector<std::int32_t> sorted(fineCount);
  {
    std::vector<std::int32_t> cursor(blockStart.begin(), blockStart.end() - 1);
    for (std::int32_t n = 0; n < fineCount; ++n) sorted[cursor[t.aggregate[n]]++] = n;
  }

  // Pieces of each block that hang together through uncut links; cells of a piece become adjacent.
  std::vector<std::int32_t> piece(fineCount);  // by position in `sorted`
  std::vector<std::int32_t> pieceCount(blocks, 0);
  parallelForBlocks(blocks, 1 << 12, [&](std::size_t begin, std::size_t end) {
    std::vector<std::int32_t> root, order;
    for (std::size_t k = begin; k < end; ++k) {
      const std::int32_t first = blockStart[k], cells = blockStart[k + 1] - first;
      if (cells == 0) continue;
      root.resize(cells);
      for (std::int32_t c = 0; c < cells; ++c) root[c] = c;
      const auto find = [&](std::int32_t c) {
        while (root[c] != c) c = root[c];
        return c;
      };
      for (std::int32_t c = 0; cells > 1 && c < cells; ++c) {
        forEachLink(level, sorted[first + c], [&](std::int32_t m, int, float) {
          if (t.aggregate[m] != static_cast<std::int32_t>(k)) return;
          const auto at =
              std::lower_bound(sorted.begin() + first, sorted.begin() + first + cells, m);
          const std::int32_t one = find(c);
          const std::int32_t two = find(static_cast<std::int32_t>(at - sorted.begin()) - first);
          if (one != two) root[std::max(one, two)] = std::min(one, two);
        });
      }
      std::int32_t pieces = 0;
      order.assign(cells, -1);
      for (std::int32_t c = 0; c < cells; ++c) {
        const std::int32_t r = find(c);
        if (order[r] < 0) order[r] = pieces++;
        piece[first + c] = order[r];
      }
      pieceCount[k] = pieces;
    }
  });

  // Even blocks' pieces first, each colour in storage order.
  Level next;
  std::vector<std::int32_t> firstPiece(blocks);
  std::int32_t number = 0;
  for (int colour = 0; colour < 2; ++colour) {
    std::size_t k = 0;
    for (std::int32_t z = 0; z < size[2]; ++z) {
      for (std::int32_t y = 0; y < size[1]; ++y) {
        for (std::int32_t x = 0; x < size[0]; ++x, ++k) {
          if (((x + y + z) & 1) != colour || pieceCount[k] == 0) continue;
          firstPiece[k] = number;
          number += pieceCount[k];
          next.block.insert(next.block.end(), pieceCount[k], {x, y, z});
        }
      }
    }
    if (colour == 0) next.red = number;
  }
  next.count = number;
  t.childStart.assign(number + 1, 0);
  for (std::size_t k = 0; k < blocks; ++k) {
    for (std::int32_t s = blockStart[k]; s < blockStart[k + 1]; ++s) {
      t.aggregate[sorted[s]] = firstPiece[k] + piece[s];
      ++t.childStart[firstPiece[k] + piece[s] + 1];
    }
  }
  for (std::int32_t c = 0; c < number; ++c) t.childStart[c + 1] += t.childStart[c];
  t.child.resize(fineCount);
  {
    std::vector<std::int32_t> cursor(t.childStart.begin(), t.childStart.end() - 1);
    for (std::int32_t n = 0; n < fineCount; ++n) t.child[cursor[t.aggregate[n]]++] = n;
  }

  // Where linear interpolation looks: the coarser cell on the side of the block that a cell is on.
  int halved = 0;
  for (int a = 0; a < 3; ++a) halved += coarsened[a];
  t.ownWeight = 1 - 0.25F * static_cast<float>(halved);
  t.toward.resize(fineCount);
  parallelFor(fineCount, kGrain, [&](std::size_t index) {
    const auto n = static_cast<std::int32_t>(index);
    const auto b = blockOf(level, n);
    t.toward[n] = {-1, -1, -1};
    for (int a = 0; a < 3; ++a) {
      if (!coarsened[a]) continue;
      const int d = 2 * a + (b[a] & 1);
      if (level == 0) {
        const std::int32_t m = annulus.links[n][d];
        t.toward[n][a] = m >= 0 ? t.aggregate[m] : m == kInsulated ? t.aggregate[n] : -1;
      } else {
        // No neighbour and no boundary along this axis means insulation.
        bool found = false;
        forEachLink(level, n, [&](std::int32_t m, int axis, float) {
          if (found || axis != a) return;
          const std::int32_t side = blockOf(level, m)[a] - b[a];
          if (side != signOf(d)) return;
          t.toward[n][a] = t.aggregate[m];
          found = true;
        });
        if (!found && coarse[level - 1].boundaryFaces[n][a] == 0) t.toward[n][a] = t.aggregate[n];
      }
    }
  });

  // Coarser conductances: faces add up; distances double along a coarsened axis, and a boundary
  // moves half a finer cell away from the coarser cell's centre.
  std::vector<std::int32_t> rowLength(number + 1, 0);
  struct Link {
    std::int32_t column;
    std::uint8_t axis;
    float coefficient;
  };
  const auto gather = [&](std::int32_t c, std::vector<Link>& row) {
    row.clear();
    for (std::int32_t s = t.childStart[c]; s < t.childStart[c + 1]; ++s) {
      forEachLink(level, t.child[s], [&](std::int32_t m, int axis, float conductance) {
        const std::int32_t other = t.aggregate[m];
        if (other == c) return;
        const float scaled = coarsened[axis] ? 0.5F * conductance : conductance;
        for (Link& link : row) {
          if (link.column == other) {
            link.coefficient += scaled;
            return;
          }
        }
        row.push_back({other, static_cast<std::uint8_t>(axis), scaled});
      });
    }
  };
  parallelForBlocks(number, 1 << 11, [&](std::size_t begin, std::size_t end) {
    std::vector<Link> row;
    for (std::size_t c = begin; c < end; ++c) {
      gather(static_cast<std::int32_t>(c), row);
      rowLength[c + 1] = static_cast<std::int32_t>(row.size());
    }
  });
  for (std::int32_t c = 0; c < number; ++c) rowLength[c + 1] += rowLength[c];
  next.start = std::move(rowLength);
  next.column.resize(next.start[number]);
  next.axis.resize(next.start[number]);
  next.coefficient.resize(next.start[number]);
  next.inverseDiagonal.resize(number);
  next.boundaryFaces.assign(number, {0, 0, 0});
  next.boundaryConductance.assign(number, {0, 0, 0});
  next.x.resize(number);
  next.b.resize(number);
  parallelForBlocks(number, 1 << 11, [&](std::size_t begin, std::size_t end) {
    std::vector<Link> row;
    for (std::size_t index = begin; index < end; ++index) {
      const auto c = static_cast<std::int32_t>(index);
      gather(c, row);
      double diagonal = 0;
      std::int32_t e = next.start[c];
      for (const Link& link : row) {
        next.column[e] = link.column;
        next.axis[e] = link.axis;
        next.coefficient[e] = link.coefficient;
        diagonal += link.coefficient;
        ++e;
      }
      for (std::int32_t s = t.childStart[c]; s < t.childStart[c + 1]; ++s) {
        const std::int32_t n = t.child[s];
        for (int a = 0; a < 3; ++a) {
          const float shift = coarsened[a] ? 0.5F * extent[a] : 0.0F;
          if (level == 0) {
            const std::int32_t irregular = annulus.irregular(n);
            if (irregular < 0) continue;
            for (int d = 2 * a; d < 2 * a + 2; ++d) {
              const std::int32_t m = annulus.links[n][d];
              if (m != kInner && m != kOuter) continue;
              next.boundaryFaces[c][a] += 1;
              next.boundaryConductance[c][a] += unit[a] / (annulus.fractions[irregular][d] + shift);
            }
          } else {
            const float faces = coarse[level - 1].boundaryFaces[n][a];
            if (faces == 0) continue;
            const float distance = faces * unit[a] / coarse[level - 1].boundaryConductance[n][a];
            next.boundaryFaces[c][a] += faces;
            next.boundaryConductance[c][a] += faces * unit[a] / (distance + shift);
          }
        }
      }
      for (int a = 0; a < 3; ++a) diagonal += next.boundaryConductance[c][a];
      next.inverseDiagonal[c] = diagonal > 0 ? static_cast<float>(1 / diagonal) : 0.0F;
    }
  });
  coarse.push_back(std::move(next));
  transfers.push_back(std::move(t));
}

void Multigrid::Hierarchy::smoothCoarse(Level& l, bool fromZero) const {
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

void Multigrid::Hierarchy::prolong(int level, std::vector<float>& x) const {
  const Transfer& t = transfers[level];
  const std::vector<float>& e = coarse[level].x;
  parallelFor(x.size(), kGrain, [&](std::size_t n) {
    float sum = t.ownWeight * e[t.aggregate[n]];
    for (int a = 0; a < 3; ++a) {
      if (t.toward[n][a] >= 0) sum += 0.25F * e[t.toward[n][a]];
    }
    x[n] += sum;
  });
}

void Multigrid::Hierarchy::solve(int level) {  // level >= 1
  Level& l = coarse[level - 1];
  if (level == static_cast<int>(coarse.size())) {
    smoothCoarse(l, true);
    for (int sweep = 1; sweep < kCoarsestSweeps; ++sweep) smoothCoarse(l, false);
    return;
  }
  smoothCoarse(l, true);
  // After the sweep only even cells have a residual.
  const Transfer& t = transfers[level];
  Level& next = coarse[level];
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

void Multigrid::Hierarchy::cycle(const std::vector<float>& r, std::vector<float>& e) {
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
    const Transfer& t = transfers[0];
    Level& next = coarse[0];
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

Multigrid::Multigrid(const Annulus& annulus) : hierarchy_(std::make_unique<Hierarchy>(annulus)) {}
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
  const Hierarchy& h = *hierarchy_;
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
