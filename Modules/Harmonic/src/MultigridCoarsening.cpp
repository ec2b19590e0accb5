// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Parallel.h"
#include "MultigridHierarchy.h"

#include <algorithm>
#include <utility>

namespace explica::harmonic {

namespace {

constexpr std::size_t kCoarseningGrain = 1 << 13;  // elements a task
constexpr int kCoarsestSize = 60;                  // cells; solved by sweeps
constexpr int kMaxLevels = 16;                     // of grids, each half as wide as the one before
// Axes are coarsened together if their spacings differ by less than this; so smoothing stays good.
constexpr double kNearlyIsotropic = 1.5;

using Subscripts = std::array<std::int32_t, 3>;

/// Finer cells by the block of the coarser grid that they lie in, in the finer cells' order.
struct Blocks {
  Subscripts size{};
  std::vector<std::int32_t> start;   ///< per block, into `sorted`; one more at the end
  std::vector<std::int32_t> sorted;  ///< finer cells
  std::vector<std::int32_t> of;      ///< per finer cell: its block

  [[nodiscard]] std::size_t count() const { return start.size() - 1; }
};

/// Connected pieces of the blocks; each becomes a coarser cell.
struct Pieces {
  std::vector<std::int32_t> of;     ///< by position in Blocks::sorted: number within the block
  std::vector<std::int32_t> count;  ///< per block
};

/// A coarser link while its row is put together.
struct Link {
  std::int32_t column;
  std::uint8_t axis;
  float coefficient;
};

/// Makes one coarser level out of a finer one, step by step.
class Coarsener {
 public:
  Coarsener(const MultigridHierarchy& hierarchy, int level, const std::array<bool, 3>& coarsened,
            const std::array<float, 3>& extent)
      : h_(hierarchy), level_(level), extent_(extent), fineCount_(hierarchy.countOf(level)) {
    t_.coarsened = coarsened;
  }

  void run() {
    sortByBlock();
    findPieces();
    numberPieces();
    gatherChildren();
    placeInterpolation();
    sumLinks();
    sumBoundary();
  }

  [[nodiscard]] MultigridLevel takeLevel() { return std::move(next_); }
  [[nodiscard]] MultigridTransfer takeTransfer() { return std::move(t_); }

 private:
  [[nodiscard]] Subscripts sizeOfBlocks() const;
  [[nodiscard]] Subscripts parentOf(Subscripts block) const;
  [[nodiscard]] std::int32_t towardAt(std::int32_t n, int axis) const;
  void sortByBlock();
  [[nodiscard]] bool isWhole(std::int32_t first, std::int32_t cells) const;
  void piecesOf(std::size_t block, std::vector<std::int32_t>& root,
                std::vector<std::int32_t>& order);
  void findPieces();
  void numberPieces();
  void gatherChildren();
  void placeInterpolation();
  void gatherRow(std::int32_t c, std::vector<Link>& row) const;
  void sumLinks();
  void addBoundaryOf(std::int32_t n, int axis, float& faces, float& conductance) const;
  void sumBoundary();

  MultigridLevel next_;
  MultigridTransfer t_;
  const MultigridHierarchy& h_;
  int level_;
  std::array<float, 3> extent_;
  std::int32_t fineCount_;
  Blocks blocks_;
  Pieces pieces_;
  std::vector<std::int32_t> firstPiece_;  // per block
};

Subscripts Coarsener::sizeOfBlocks() const {
  Subscripts top = {0, 0, 0};
  if (level_ == 0) {
    for (int a = 0; a < 3; ++a) top[a] = h_.annulus.size[a] - 1;
  } else {
    for (const auto& b : h_.coarse[level_ - 1].block) {
      for (int a = 0; a < 3; ++a) top[a] = std::max(top[a], b[a]);
    }
  }
  for (int a = 0; a < 3; ++a) top[a] = (t_.coarsened[a] ? top[a] / 2 : top[a]) + 1;
  return top;
}

Subscripts Coarsener::parentOf(Subscripts block) const {
  for (int a = 0; a < 3; ++a) {
    if (t_.coarsened[a]) block[a] >>= 1;
  }
  return block;
}

void Coarsener::sortByBlock() {
  const Subscripts size = sizeOfBlocks();
  const auto stride = static_cast<std::size_t>(size[0]);
  const std::size_t blocks = stride * size[1] * size[2];
  blocks_.size = size;
  blocks_.start.assign(blocks + 1, 0);
  blocks_.of.resize(fineCount_);
  parallelFor(fineCount_, kCoarseningGrain, [&](std::size_t n) {
    const Subscripts b = parentOf(h_.blockOf(level_, static_cast<std::int32_t>(n)));
    blocks_.of[n] = static_cast<std::int32_t>(
        b[0] + stride * (b[1] + static_cast<std::size_t>(size[1]) * b[2]));
  });
  for (std::int32_t n = 0; n < fineCount_; ++n) ++blocks_.start[blocks_.of[n] + 1];
  for (std::size_t k = 0; k < blocks; ++k) blocks_.start[k + 1] += blocks_.start[k];
  blocks_.sorted.resize(fineCount_);
  std::vector<std::int32_t> cursor(blocks_.start.begin(), blocks_.start.end() - 1);
  for (std::int32_t n = 0; n < fineCount_; ++n) blocks_.sorted[cursor[blocks_.of[n]]++] = n;
}

/// Whether cells of one block plainly hang together: all eight are there and no link of theirs
/// ends.
bool Coarsener::isWhole(std::int32_t first, std::int32_t cells) const {
  if (level_ > 0 || cells != 8) return false;
  for (std::int32_t s = first; s < first + cells; ++s) {
    if (h_.annulus.irregular(blocks_.sorted[s]) >= 0) return false;
  }
  return true;
}

/// Joins the block's cells along uncut links (union-find in `root`) and numbers what hangs
/// together.
void Coarsener::piecesOf(std::size_t block, std::vector<std::int32_t>& root,
                         std::vector<std::int32_t>& order) {
  const std::int32_t first = blocks_.start[block], cells = blocks_.start[block + 1] - first;
  if (cells == 0) return;
  if (isWhole(first, cells)) {
    std::fill_n(pieces_.of.begin() + first, cells, 0);
    pieces_.count[block] = 1;
    return;
  }
  root.resize(cells);
  for (std::int32_t c = 0; c < cells; ++c) root[c] = c;
  const auto find = [&](std::int32_t c) {
    while (root[c] != c) c = root[c];
    return c;
  };
  const auto begin = blocks_.sorted.begin() + first;
  for (std::int32_t c = 0; cells > 1 && c < cells; ++c) {
    h_.forEachLink(level_, blocks_.sorted[first + c], [&](std::int32_t m, int, float) {
      if (blocks_.of[m] != static_cast<std::int32_t>(block)) return;
      const auto at = std::lower_bound(begin, begin + cells, m);
      const std::int32_t one = find(c), two = find(static_cast<std::int32_t>(at - begin));
      if (one != two) root[std::max(one, two)] = std::min(one, two);
    });
  }
  std::int32_t pieces = 0;
  order.assign(cells, -1);
  for (std::int32_t c = 0; c < cells; ++c) {
    const std::int32_t r = find(c);
    if (order[r] < 0) order[r] = pieces++;
    pieces_.of[first + c] = order[r];
  }
  pieces_.count[block] = pieces;
}

/// Pieces of each block that hang together; cells of neighbouring pieces become adjacent.
void Coarsener::findPieces() {
  pieces_.of.resize(fineCount_);
  pieces_.count.assign(blocks_.count(), 0);
  parallelForBlocks(blocks_.count(), 1 << 12, [&](std::size_t begin, std::size_t end) {
    std::vector<std::int32_t> root, order;
    for (std::size_t k = begin; k < end; ++k) piecesOf(k, root, order);
  });
}

/// Even blocks' pieces first, each colour in storage order.
void Coarsener::numberPieces() {
  const Subscripts& size = blocks_.size;
  firstPiece_.resize(blocks_.count());
  std::int32_t number = 0;
  for (int colour = 0; colour < 2; ++colour) {
    std::size_t k = 0;
    for (std::int32_t z = 0; z < size[2]; ++z) {
      for (std::int32_t y = 0; y < size[1]; ++y) {
        for (std::int32_t x = 0; x < size[0]; ++x, ++k) {
          if (((x + y + z) & 1) != colour || pieces_.count[k] == 0) continue;
          firstPiece_[k] = number;
          number += pieces_.count[k];
          next_.block.insert(next_.block.end(), pieces_.count[k], {x, y, z});
        }
      }
    }
    if (colour == 0) next_.red = number;
  }
  next_.count = number;
}

void Coarsener::gatherChildren() {
  t_.aggregate.resize(fineCount_);
  t_.childStart.assign(next_.count + 1, 0);
  for (std::size_t k = 0; k < blocks_.count(); ++k) {
    for (std::int32_t s = blocks_.start[k]; s < blocks_.start[k + 1]; ++s) {
      const std::int32_t c = firstPiece_[k] + pieces_.of[s];
      t_.aggregate[blocks_.sorted[s]] = c;
      ++t_.childStart[c + 1];
    }
  }
  for (std::int32_t c = 0; c < next_.count; ++c) t_.childStart[c + 1] += t_.childStart[c];
  t_.child.resize(fineCount_);
  std::vector<std::int32_t> cursor(t_.childStart.begin(), t_.childStart.end() - 1);
  for (std::int32_t n = 0; n < fineCount_; ++n) t_.child[cursor[t_.aggregate[n]]++] = n;
}

/// The coarser cell beside finer cell n, on the side of the block that n is on; n's own where the
/// side is insulated, the one after the last at a boundary.
std::int32_t Coarsener::towardAt(std::int32_t n, int axis) const {
  const Subscripts b = h_.blockOf(level_, n);
  const int side = 2 * axis + (b[axis] & 1);
  if (level_ == 0) {
    const std::int32_t m = h_.annulus.links[n][side];
    return m >= 0 ? t_.aggregate[m] : m == kInsulated ? t_.aggregate[n] : next_.count;
  }
  std::int32_t found = -1;
  h_.forEachLink(level_, n, [&](std::int32_t m, int along, float) {
    if (found >= 0 || along != axis) return;
    if (h_.blockOf(level_, m)[axis] - b[axis] == signOf(side)) found = t_.aggregate[m];
  });
  if (found >= 0) return found;
  // No neighbour and no boundary along this axis means insulation.
  return h_.coarse[level_ - 1].boundaryFaces[n][axis] == 0 ? t_.aggregate[n] : next_.count;
}

/// Where linear interpolation looks, per coarsened axis.
void Coarsener::placeInterpolation() {
  int halved = 0;
  for (int a = 0; a < 3; ++a) halved += t_.coarsened[a];
  t_.ownWeight = 1 - 0.25F * static_cast<float>(halved);
  t_.toward.resize(fineCount_);
  parallelFor(fineCount_, kCoarseningGrain, [&](std::size_t index) {
    const auto n = static_cast<std::int32_t>(index);
    for (int a = 0; a < 3; ++a) t_.toward[n][a] = t_.coarsened[a] ? towardAt(n, a) : next_.count;
  });
}

/// Links of coarser cell c: conductances of the faces add up; distances double along a coarsened
/// axis.
void Coarsener::gatherRow(std::int32_t c, std::vector<Link>& row) const {
  row.clear();
  for (std::int32_t s = t_.childStart[c]; s < t_.childStart[c + 1]; ++s) {
    h_.forEachLink(level_, t_.child[s], [&](std::int32_t m, int axis, float conductance) {
      const std::int32_t other = t_.aggregate[m];
      if (other == c) return;
      const float scaled = t_.coarsened[axis] ? 0.5F * conductance : conductance;
      for (Link& link : row) {
        if (link.column == other) {
          link.coefficient += scaled;
          return;
        }
      }
      row.push_back({other, static_cast<std::uint8_t>(axis), scaled});
    });
  }
}

void Coarsener::sumLinks() {
  constexpr std::size_t kRowsGrain = 1 << 11;  // cells a task
  const std::int32_t number = next_.count;
  next_.start.assign(number + 1, 0);
  std::vector<std::vector<Link>> rowsOf((number + kRowsGrain - 1) /
                                        kRowsGrain);  // of each task's cells
  parallelForBlocks(number, kRowsGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Link>& rows = rowsOf[begin / kRowsGrain];
    std::vector<Link> row;
    for (std::size_t c = begin; c < end; ++c) {
      gatherRow(static_cast<std::int32_t>(c), row);
      next_.start[c + 1] = static_cast<std::int32_t>(row.size());
      rows.insert(rows.end(), row.begin(), row.end());
    }
  });
  for (std::int32_t c = 0; c < number; ++c) next_.start[c + 1] += next_.start[c];
  next_.column.resize(next_.start[number]);
  next_.axis.resize(next_.start[number]);
  next_.coefficient.resize(next_.start[number]);
  parallelFor(rowsOf.size(), 1, [&](std::size_t task) {
    std::int32_t e = next_.start[task * kRowsGrain];
    for (const Link& link : rowsOf[task]) {
      next_.column[e] = link.column;
      next_.axis[e] = link.axis;
      next_.coefficient[e] = link.coefficient;
      ++e;
    }
  });
}

/// Adds what finer cell n has of the boundary along an axis: its faces, and their conductance with
/// the boundary moved half a finer cell away from the coarser cell's centre.
void Coarsener::addBoundaryOf(std::int32_t n, int axis, float& faces, float& conductance) const {
  const float shift = t_.coarsened[axis] ? 0.5F * extent_[axis] : 0.0F;
  if (level_ > 0) {
    const MultigridLevel& finer = h_.coarse[level_ - 1];
    const float own = finer.boundaryFaces[n][axis];
    if (own == 0) return;
    const float distance = own * h_.unit[axis] / finer.boundaryConductance[n][axis];
    faces += own;
    conductance += own * h_.unit[axis] / (distance + shift);
    return;
  }
  const std::int32_t irregular = h_.annulus.irregular(n);
  if (irregular < 0) return;
  for (int d = 2 * axis; d < 2 * axis + 2; ++d) {
    const std::int32_t m = h_.annulus.links[n][d];
    if (m != kInner && m != kOuter) continue;
    faces += 1;
    conductance += h_.unit[axis] / (h_.annulus.fractions[irregular][d] + shift);
  }
}

void Coarsener::sumBoundary() {
  const std::int32_t number = next_.count;
  next_.inverseDiagonal.resize(number);
  next_.boundaryFaces.assign(number, {0, 0, 0});
  next_.boundaryConductance.assign(number, {0, 0, 0});
  next_.x.resize(number + 1);
  next_.b.resize(number);
  parallelFor(number, 1 << 11, [&](std::size_t c) {
    double diagonal = 0;
    for (std::int32_t e = next_.start[c]; e < next_.start[c + 1]; ++e) {
      diagonal += next_.coefficient[e];
    }
    auto& faces = next_.boundaryFaces[c];
    auto& conductance = next_.boundaryConductance[c];
    for (std::int32_t s = t_.childStart[c]; s < t_.childStart[c + 1]; ++s) {
      for (int a = 0; a < 3; ++a) addBoundaryOf(t_.child[s], a, faces[a], conductance[a]);
    }
    for (int a = 0; a < 3; ++a) diagonal += conductance[a];
    next_.inverseDiagonal[c] = diagonal > 0 ? static_cast<float>(1 / diagonal) : 0.0F;
  });
}

}  // namespace

void MultigridHierarchy::build() {
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

void MultigridHierarchy::coarsen(int level, const std::array<bool, 3>& coarsened,
                                 const std::array<float, 3>& extent) {
  Coarsener step(*this, level, coarsened, extent);
  step.run();
  coarse.push_back(step.takeLevel());
  transfers.push_back(step.takeTransfer());
}

}  // namespace explica::harmonic
