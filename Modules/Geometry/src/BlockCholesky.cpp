// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/BlockCholesky.h"

#include "DenseKernels.h"

#include "Explica/Core/Parallel.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <algorithm>
#include <atomic>
#include <numeric>

namespace explica::geometry {
namespace {

using Panel = Eigen::Map<Eigen::MatrixXd>;

/// Parent of each column in the elimination tree, -1 of roots [Liu1990]; `upper` lists the columns
/// below i of each row i.
std::vector<std::int32_t> eliminationTree(const BlockPattern& upper) {
  const std::int32_t n = upper.count();
  std::vector<std::int32_t> parent(n, -1), ancestor(n, -1);
  for (std::int32_t i = 0; i < n; ++i) {
    for (std::int32_t e = upper.begin[i]; e < upper.begin[i + 1]; ++e) {
      for (std::int32_t j = upper.rows[e]; j != -1 && j < i;) {
        const std::int32_t next = ancestor[j];
        ancestor[j] = i;
        if (next == -1) parent[j] = i;
        j = next;
      }
    }
  }
  return parent;
}

/// Columns left of the diagonal for each row, ascending.
BlockPattern transposed(const BlockPattern& lower) {
  const std::int32_t n = lower.count();
  BlockPattern upper;
  upper.begin.assign(static_cast<std::size_t>(n) + 1, 0);
  for (std::int32_t j = 0; j < n; ++j) {
    for (std::int32_t e = lower.begin[j] + 1; e < lower.begin[j + 1]; ++e) {
      ++upper.begin[lower.rows[e] + 1];
    }
  }
  std::partial_sum(upper.begin.begin(), upper.begin.end(), upper.begin.begin());
  upper.rows.resize(static_cast<std::size_t>(upper.begin[n]));
  std::vector<std::int32_t> at(upper.begin.begin(), upper.begin.end() - 1);
  for (std::int32_t j = 0; j < n; ++j) {
    for (std::int32_t e = lower.begin[j] + 1; e < lower.begin[j + 1]; ++e) {
      upper.rows[at[lower.rows[e]]++] = j;
    }
  }
  return upper;
}

/// Children before parents, subtrees together.
std::vector<std::int32_t> postorderPlaces(const std::vector<std::int32_t>& parent) {
  const auto n = static_cast<std::int32_t>(parent.size());
  std::vector<std::int32_t> firstChild(n, -1), sibling(n, -1);
  for (std::int32_t j = n - 1; j >= 0; --j) {
    if (parent[j] < 0) continue;
    sibling[j] = firstChild[parent[j]];
    firstChild[parent[j]] = j;
  }
  std::vector<std::int32_t> place(n, -1), stack;
  std::int32_t next = 0;
  for (std::int32_t root = 0; root < n; ++root) {
    if (parent[root] >= 0) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const std::int32_t j = stack.back();
      if (firstChild[j] >= 0) {
        stack.push_back(firstChild[j]);
        firstChild[j] = sibling[firstChild[j]];
      } else {
        stack.pop_back();
        place[j] = next++;
      }
    }
  }
  return place;
}

/// Adds block columns first ... end - 1 of the lower triangle of a child's remainder, block by
/// block, into its parent's front.
template <int Size>
void extendAdd(const Eigen::MatrixXd& update, std::span<const std::int32_t> parentRow,
               Eigen::Index first, Eigen::Index end, Eigen::Index width, Panel& panel,
               Eigen::MatrixXd& rest) {
  const auto count = static_cast<Eigen::Index>(parentRow.size());
  for (Eigen::Index j = first; j < end; ++j) {
    const Eigen::Index column = Size * static_cast<Eigen::Index>(parentRow[j]);
    for (int k = 0; k < Size; ++k) {
      const double* from = &update(0, Size * j + k);
      double* to = column < width ? &panel(0, column + k) : &rest(0, column - width + k) - width;
      for (Eigen::Index i = j; i < count; ++i) {
        double* at = to + Size * static_cast<Eigen::Index>(parentRow[i]);
        for (int l = 0; l < Size; ++l) at[l] += from[Size * i + l];
      }
    }
  }
}

using kernels::DenseBlock;

constexpr std::ptrdiff_t kPanel = 96;  // columns eliminated before those to their right follow
constexpr std::ptrdiff_t kTile = 192;  // rows or columns of what one task updates

/// Calls part(begin, count) for tiles of [0, size), on several threads if `tiled`.
template <class Part>
void inTiles(std::ptrdiff_t size, bool tiled, const Part& part) {
  const auto one = [&](std::size_t n) {
    const std::ptrdiff_t begin = static_cast<std::ptrdiff_t>(n) * kTile;
    part(begin, std::min(kTile, size - begin));
  };
  const auto tiles = static_cast<std::size_t>((size + kTile - 1) / kTile);
  if (tiled) {
    parallelFor(tiles, 1, one);
  } else {
    for (std::size_t n = 0; n < tiles; ++n) one(n);
  }
}

DenseBlock partOf(const DenseBlock& of, std::ptrdiff_t row, std::ptrdiff_t column,
                  std::ptrdiff_t rows, std::ptrdiff_t columns) {
  return {of.at(row, column), rows, columns, of.stride};
}

/// Eliminates columns first ... first + count - 1 of the panel, a few at a time.
bool eliminateColumns(const DenseBlock& panel, std::ptrdiff_t first, std::ptrdiff_t count,
                      bool tiled) {
  const std::ptrdiff_t end = first + count;
  for (std::ptrdiff_t c = first; c < end; c += kernels::kMostColumns) {
    const std::ptrdiff_t own = std::min(kernels::kMostColumns, end - c), next = c + own;
    const DenseBlock corner = partOf(panel, c, c, own, own);
    if (!kernels::factoriseCorner(corner)) return false;
    inTiles(panel.rows - next, tiled, [&](std::ptrdiff_t row, std::ptrdiff_t rows) {
      kernels::solveBelow(corner, partOf(panel, next + row, c, rows, own));
    });
    if (next == end) continue;
    const DenseBlock right = partOf(panel, next, c, end - next, own);
    inTiles(panel.rows - next, tiled, [&](std::ptrdiff_t row, std::ptrdiff_t rows) {
      kernels::subtractProduct(partOf(panel, next + row, c, rows, own), right,
                               partOf(panel, next + row, next, rows, end - next), row);
    });
  }
  return true;
}

/// Lower triangle of `trailing` -= under * under^T, as far as `trailing` has columns.
void updateTrailing(const DenseBlock& trailing, const DenseBlock& under, bool tiled) {
  inTiles(trailing.columns, tiled, [&](std::ptrdiff_t begin, std::ptrdiff_t count) {
    const std::ptrdiff_t rows = trailing.rows - begin;
    kernels::subtractProduct(partOf(under, begin, 0, rows, under.columns),
                             partOf(under, begin, 0, count, under.columns),
                             partOf(trailing, begin, begin, rows, count));
  });
}

/// Zeros in a column of a square matrix, as far up as updateTrailing() reads.
void clearLower(Eigen::MatrixXd& square, std::ptrdiff_t column) {
  const std::ptrdiff_t first = column - column % kTile;
  square.col(column).tail(square.rows() - first).setZero();
}

/// Eliminates the columns of `panel` (height x width); `rest` becomes what remains for the parent.
bool eliminateDense(Panel& columns, Eigen::MatrixXd& rest, bool tiled) {
  const std::ptrdiff_t width = columns.cols(), height = columns.rows();
  const DenseBlock panel = {columns.data(), height, width, height};
  const DenseBlock remains = {rest.data(), rest.rows(), rest.cols(), rest.rows()};
  for (std::ptrdiff_t begin = 0; begin < width; begin += kPanel) {
    const std::ptrdiff_t count = std::min(kPanel, width - begin), end = begin + count;
    if (!eliminateColumns(panel, begin, count, tiled)) return false;
    if (end < width) {
      updateTrailing(partOf(panel, end, end, height - end, width - end),
                     partOf(panel, end, begin, height - end, count), tiled);
    }
    if (remains.rows > 0) {
      updateTrailing(remains, partOf(panel, width, begin, height - width, count), tiled);
    }
  }
  return true;
}

using EdgeSpan = std::span<const std::pair<std::int32_t, std::int32_t>>;

/// Symmetric, ones on the diagonal and where points are joined.
Eigen::SparseMatrix<double> graphOf(std::int32_t count, EdgeSpan edges) {
  std::vector<std::int32_t> begin(static_cast<std::size_t>(count) + 1, 0);
  for (std::int32_t n = 0; n < count; ++n) begin[n + 1] = 1;
  for (const auto& [i, j] : edges) {
    ++begin[i + 1];
    ++begin[j + 1];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  Eigen::SparseMatrix<double> graph(count, count);
  graph.resizeNonZeros(begin.back());
  std::ranges::copy(begin, graph.outerIndexPtr());
  std::int32_t* const rows = graph.innerIndexPtr();
  std::fill_n(graph.valuePtr(), begin.back(), 1.0);
  std::vector<std::int32_t> at(begin.begin(), begin.end() - 1);
  for (std::int32_t n = 0; n < count; ++n) rows[at[n]++] = n;
  for (const auto& [i, j] : edges) {
    rows[at[i]++] = j;
    rows[at[j]++] = i;
  }
  for (std::int32_t n = 0; n < count; ++n) std::sort(rows + begin[n], rows + begin[n + 1]);
  return graph;
}

std::vector<std::int32_t> placesOf(std::int32_t count, EdgeSpan edges) {
  const Eigen::SparseMatrix<double> graph = graphOf(count, edges);
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(graph, order);
  std::vector<std::int32_t> place(static_cast<std::size_t>(count));
  for (std::int32_t n = 0; n < count; ++n) place[order.indices()[n]] = n;

  BlockPattern upper;
  upper.begin.assign(static_cast<std::size_t>(count) + 1, 0);
  for (const auto& [i, j] : edges) ++upper.begin[std::max(place[i], place[j]) + 1];
  std::partial_sum(upper.begin.begin(), upper.begin.end(), upper.begin.begin());
  upper.rows.resize(edges.size());
  std::vector<std::int32_t> at(upper.begin.begin(), upper.begin.end() - 1);
  for (const auto& [i, j] : edges) {
    upper.rows[at[std::max(place[i], place[j])]++] = std::min(place[i], place[j]);
  }
  const std::vector<std::int32_t> post = postorderPlaces(eliminationTree(upper));
  for (std::int32_t& p : place) p = post[p];
  return place;
}

void layOut(Elimination& elimination, EdgeSpan edges) {
  const std::vector<std::int32_t>& place = elimination.place;
  const auto count = static_cast<std::int32_t>(place.size());
  std::vector<std::int32_t>& begin = elimination.pattern.begin;
  begin.assign(place.size() + 1, 1);
  begin[0] = 0;
  for (const auto& [i, j] : edges) ++begin[std::min(place[i], place[j]) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  struct Entry {
    std::int32_t row, edge;
  };
  std::vector<Entry> entries(static_cast<std::size_t>(begin.back()));
  std::vector<std::int32_t> at(begin.begin(), begin.end() - 1);
  for (std::int32_t n = 0; n < count; ++n) entries[at[n]++] = {n, 0};
  for (std::size_t n = 0; n < edges.size(); ++n) {
    const std::int32_t i = place[edges[n].first], j = place[edges[n].second];
    const auto edge = static_cast<std::int32_t>(n);
    entries[at[std::min(i, j)]++] = {std::max(i, j), i > j ? edge : ~edge};
  }
  elimination.pattern.rows.resize(entries.size());
  elimination.edge.resize(entries.size());
  parallelFor(place.size(), [&](std::size_t c) {
    std::sort(entries.begin() + begin[c], entries.begin() + begin[c + 1],
              [](const Entry& a, const Entry& b) { return a.row < b.row; });
    for (std::int32_t e = begin[c]; e < begin[c + 1]; ++e) {
      elimination.pattern.rows[e] = entries[e].row;
      elimination.edge[e] = entries[e].edge;
    }
  });
}

}  // namespace

Elimination eliminationOf(std::int32_t count, EdgeSpan edges) {
  Elimination elimination;
  elimination.place = placesOf(count, edges);
  layOut(elimination, edges);
  return elimination;
}

template <int Size>
void BlockCholesky<Size>::analyse(const BlockPattern& pattern) {
  findFronts(pattern);
  findRows(pattern);
  schedule();
}

/// Supernodes: runs of columns with like rows, and then, where few zeros are taken in, a run with
/// the run of its parent.
template <int Size>
void BlockCholesky<Size>::findFronts(const BlockPattern& pattern) {
  const std::int32_t n = pattern.count();
  const BlockPattern upper = transposed(pattern);
  const std::vector<std::int32_t> parent = eliminationTree(upper);
  std::vector<std::int32_t> below(n, 0), seen(n, -1);  // block rows below the diagonal
  for (std::int32_t i = 0; i < n; ++i) {
    seen[i] = i;
    for (std::int32_t e = upper.begin[i]; e < upper.begin[i + 1]; ++e) {
      for (std::int32_t j = upper.rows[e]; seen[j] != i; j = parent[j]) {
        seen[j] = i;
        ++below[j];
      }
    }
  }
  struct Run {
    std::int32_t first, columns, below;
    double zeros;
  };
  std::vector<Run> runs;
  const auto joins = [&](const Run& child, const Run& next) {
    if (parent[next.first - 1] != next.first) return false;  // next is not the child's parent
    // Shares of zeros that are cheaper than a front of its own, by columns.
    constexpr std::array<std::pair<std::int32_t, double>, 3> kAllowed = {
        {{4, 1.0}, {16, 0.4}, {48, 0.1}}};
    constexpr double kAlways = 0.05;
    const double columns = child.columns + next.columns;
    const double taken = child.columns * (next.columns + next.below - child.below);
    const double zeros = child.zeros + next.zeros + taken;
    const double all = columns * (columns + 1) / 2 + columns * next.below;
    double allowed = kAlways;
    for (const auto& [limit, share] : kAllowed) {
      if (columns <= limit) {
        allowed = share;
        break;
      }
    }
    return zeros <= allowed * all;
  };
  for (std::int32_t j = 0; j < n; ++j) {
    if (!runs.empty() && parent[j - 1] == j && runs.back().below == below[j] + 1) {
      ++runs.back().columns;
      runs.back().below = below[j];
    } else {
      // The run before is complete: join it, and those before it, to what they hang on.
      runs.push_back({j, 1, below[j], 0});
    }
  }
  std::vector<Run> joined;
  for (Run run : runs) {
    while (!joined.empty() && joins(joined.back(), run)) {
      const Run child = joined.back();
      joined.pop_back();
      run.zeros += child.zeros +
                   static_cast<double>(child.columns) * (run.columns + run.below - child.below);
      run.first = child.first;
      run.columns += child.columns;
    }
    joined.push_back(run);
  }
  fronts_.clear();
  std::vector<std::int32_t> frontOf(n);
  for (const Run& run : joined) {
    for (std::int32_t j = run.first; j < run.first + run.columns; ++j) {
      frontOf[j] = static_cast<std::int32_t>(fronts_.size());
    }
    Front front;
    front.first = run.first;
    front.columns = run.columns;
    fronts_.push_back(front);
  }
  children_.assign(fronts_.size(), {});
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    const std::int32_t above = parent[fronts_[f].first + fronts_[f].columns - 1];
    if (above < 0) continue;
    fronts_[f].parent = frontOf[above];
    children_[fronts_[f].parent].push_back(static_cast<std::int32_t>(f));
  }
}

template <int Size>
void BlockCholesky<Size>::findRows(const BlockPattern& pattern) {
  rows_.clear();
  std::vector<std::int32_t> seen(static_cast<std::size_t>(pattern.count()), -1);
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    Front& front = fronts_[f];
    const std::int32_t end = front.first + front.columns;
    front.rowsBegin = static_cast<std::int32_t>(rows_.size());
    const auto take = [&](std::int32_t row) {
      if (row < end || seen[row] == static_cast<std::int32_t>(f)) return;
      seen[row] = static_cast<std::int32_t>(f);
      rows_.push_back(row);
    };
    for (std::int32_t j = front.first; j < end; ++j) {
      for (std::int32_t e = pattern.begin[j]; e < pattern.begin[j + 1]; ++e) take(pattern.rows[e]);
    }
    for (const std::int32_t child : children_[f]) {
      for (std::int32_t n = fronts_[child].rowsBegin; n < fronts_[child].rowsEnd; ++n)
        take(rows_[n]);
    }
    front.rowsEnd = static_cast<std::int32_t>(rows_.size());
    std::sort(rows_.begin() + front.rowsBegin, rows_.end());
  }
  parentRow_.resize(rows_.size());
  for (const Front& front : fronts_) {
    if (front.parent < 0) continue;
    const Front& parent = fronts_[front.parent];
    std::int32_t at = parent.rowsBegin;
    for (std::int32_t n = front.rowsBegin; n < front.rowsEnd; ++n) {
      if (rows_[n] < parent.first + parent.columns) {
        parentRow_[n] = rows_[n] - parent.first;
        continue;
      }
      while (rows_[at] < rows_[n]) ++at;
      parentRow_[n] = parent.columns + at - parent.rowsBegin;
    }
  }
}

template <int Size>
void BlockCholesky<Size>::schedule() {
  factorSize_ = 0;
  operations_ = 0;
  firstOfSubtree_.resize(fronts_.size());
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    Front& front = fronts_[f];
    front.factorBegin = factorSize_;
    factorSize_ += front.height() * front.width();
    const auto rows = static_cast<double>(front.height()),
               width = static_cast<double>(front.width());
    front.work = width * (rows * rows - rows * width + width * width / 3) / 2;
    operations_ += front.work;
    firstOfSubtree_[f] = static_cast<std::int32_t>(f);
    for (const std::int32_t child : children_[f]) {
      front.work += fronts_[child].work;
      firstOfSubtree_[f] = std::min(firstOfSubtree_[f], firstOfSubtree_[child]);
    }
  }
  // Subtrees small enough to share out evenly; what lies above them runs front by front.
  constexpr double kSubtreeShare = 1.0 / 24;
  subtrees_.clear();
  top_.clear();
  roots_.clear();
  isTop_.assign(fronts_.size(), 0);
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    if (fronts_[f].parent < 0) roots_.push_back(static_cast<std::int32_t>(f));
    if (fronts_[f].work > kSubtreeShare * operations_) {
      isTop_[f] = 1;
      top_.push_back(static_cast<std::int32_t>(f));
    } else if (fronts_[f].parent < 0 ||
               fronts_[fronts_[f].parent].work > kSubtreeShare * operations_) {
      subtrees_.push_back(static_cast<std::int32_t>(f));
    }
  }
}

template <int Size>
bool BlockCholesky<Size>::eliminate(std::int32_t f, const BlockPattern& pattern,
                                    std::span<const Block> blocks, bool tiled) {
  const Front& front = fronts_[f];
  Panel panel(factor_.data() + front.factorBegin, front.height(), front.width());
  Eigen::MatrixXd& rest = updates_[f];
  rest.resize(Size * front.below(), Size * front.below());
  inTiles(panel.cols() + rest.cols(), tiled, [&](std::ptrdiff_t first, std::ptrdiff_t count) {
    const std::ptrdiff_t width = panel.cols(), end = first + count;
    for (std::ptrdiff_t j = first; j < end; ++j) {
      if (j < width) {
        panel.col(j).setZero();
      } else {
        clearLower(rest, j - width);
      }
    }
  });
  for (std::int32_t j = 0; j < front.columns; ++j) {
    std::int32_t at = front.rowsBegin;
    for (std::int32_t e = pattern.begin[front.first + j]; e < pattern.begin[front.first + j + 1];
         ++e) {
      const std::int32_t row = pattern.rows[e];
      std::int32_t place = row - front.first;
      if (place >= front.columns) {
        while (rows_[at] < row) ++at;
        place = front.columns + at - front.rowsBegin;
      }
      panel.template block<Size, Size>(Size * place, Size * j) = blocks[e];
    }
  }
  for (const std::int32_t child : children_[f]) {
    const std::span<const std::int32_t> parentRow(parentRow_.data() + fronts_[child].rowsBegin,
                                                  static_cast<std::size_t>(fronts_[child].below()));
    inTiles(fronts_[child].below(), tiled, [&](std::ptrdiff_t first, std::ptrdiff_t count) {
      extendAdd<Size>(updates_[child], parentRow, first, first + count, front.width(), panel, rest);
    });
    updates_[child].resize(0, 0);
  }
  return eliminateDense(panel, rest, tiled);
}

template <int Size>
bool BlockCholesky<Size>::eliminateSubtree(std::int32_t root, const BlockPattern& pattern,
                                           std::span<const Block> blocks) {
  for (std::int32_t f = firstOfSubtree_[root]; f <= root; ++f) {
    if (!eliminate(f, pattern, blocks, false)) return false;
  }
  return true;
}

/// A front and all below it; branches that are large run side by side.
template <int Size>
bool BlockCholesky<Size>::eliminateBranch(std::int32_t root, const BlockPattern& pattern,
                                          std::span<const Block> blocks) {
  if (!isTop_[root]) return eliminateSubtree(root, pattern, blocks);
  const std::vector<std::int32_t>& below = children_[root];
  std::atomic<bool> positive = true;
  parallelFor(below.size(), 1, [&](std::size_t n) {
    if (positive && !eliminateBranch(below[n], pattern, blocks)) positive = false;
  });
  return positive && eliminate(root, pattern, blocks, true);
}

template <int Size>
bool BlockCholesky<Size>::factorise(const BlockPattern& pattern, std::span<const Block> blocks) {
  factor_.resize(static_cast<std::size_t>(factorSize_));
  updates_.assign(fronts_.size(), Eigen::MatrixXd());
  std::atomic<bool> positive = true;
  parallelFor(roots_.size(), 1, [&](std::size_t n) {
    if (positive && !eliminateBranch(roots_[n], pattern, blocks)) positive = false;
  });
  updates_.clear();
  return positive;
}

/// Solves for a front's own rows.
/// @return what its columns take off the rows below
template <int Size>
void BlockCholesky<Size>::solveForward(const Front& front, Eigen::VectorXd& x,
                                       Eigen::VectorXd& below) const {
  const auto columns = columnsOf(front);
  auto own = x.segment(Size * front.first, front.width());
  columns.topRows(front.width()).template triangularView<Eigen::Lower>().solveInPlace(own);
  below.noalias() = columns.bottomRows(Size * front.below()) * own;
}

template <int Size>
void BlockCholesky<Size>::solveBackward(const Front& front, bool tiled, Eigen::VectorXd& x) const {
  const auto columns = columnsOf(front);
  Eigen::VectorXd below(Size * front.below());
  for (std::int32_t n = 0; n < front.below(); ++n) {
    below.template segment<Size>(Size * n) =
        x.template segment<Size>(Size * rows_[front.rowsBegin + n]);
  }
  auto own = x.segment(Size * front.first, front.width());
  inTiles(own.size(), tiled, [&](std::ptrdiff_t first, std::ptrdiff_t count) {
    for (std::ptrdiff_t c = first; c < first + count; ++c)
      own[c] -= columns.col(c).tail(below.size()).dot(below);
  });
  columns.topRows(front.width())
      .template triangularView<Eigen::Lower>()
      .transpose()
      .solveInPlace(own);
}

/// Forward through a subtree; what it takes off rows above is left for later.
template <int Size>
void BlockCholesky<Size>::solveSubtree(std::int32_t root, Eigen::VectorXd& x,
                                       std::vector<Taken>& above) const {
  const std::int32_t end = fronts_[root].first + fronts_[root].columns;
  Eigen::VectorXd below;
  for (std::int32_t f = firstOfSubtree_[root]; f <= root; ++f) {
    const Front& front = fronts_[f];
    solveForward(front, x, below);
    for (std::int32_t n = 0; n < front.below(); ++n) {
      const std::int32_t row = rows_[front.rowsBegin + n];
      const auto taken = below.template segment<Size>(Size * n);
      if (row < end) {
        x.template segment<Size>(Size * row) -= taken;
      } else {
        above.push_back({row, taken});
      }
    }
  }
}

/// Right sides are taken off in the order of the fronts, whoever has found what is taken.
template <int Size>
void BlockCholesky<Size>::solve(Eigen::VectorXd& x) const {
  std::vector<std::vector<Taken>> above(subtrees_.size());
  parallelFor(subtrees_.size(), 1, [&](std::size_t n) { solveSubtree(subtrees_[n], x, above[n]); });
  Eigen::VectorXd below;
  std::size_t next = 0;
  for (const std::int32_t f : top_) {
    for (; next < subtrees_.size() && subtrees_[next] < f; ++next) {
      for (const Taken& taken : above[next]) {
        x.template segment<Size>(Size * taken.row) -= taken.value;
      }
    }
    const Front& front = fronts_[f];
    solveForward(front, x, below);
    for (std::int32_t n = 0; n < front.below(); ++n) {
      x.template segment<Size>(Size * rows_[front.rowsBegin + n]) -=
          below.template segment<Size>(Size * n);
    }
  }
  for (auto f = top_.rbegin(); f != top_.rend(); ++f) solveBackward(fronts_[*f], true, x);
  parallelFor(subtrees_.size(), 1, [&](std::size_t n) {
    for (std::int32_t f = subtrees_[n]; f >= firstOfSubtree_[subtrees_[n]]; --f) {
      solveBackward(fronts_[f], false, x);
    }
  });
}

template class BlockCholesky<1>;
template class BlockCholesky<2>;
template class BlockCholesky<3>;

}  // namespace explica::geometry
