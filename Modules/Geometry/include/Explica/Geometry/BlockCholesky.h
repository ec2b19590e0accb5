// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace explica::geometry {

/// Pattern of a symmetric matrix of square blocks: block rows >= column of each column, ascending
/// and the diagonal first.
struct BlockPattern {
  std::vector<std::int32_t> begin;  ///< N + 1
  std::vector<std::int32_t> rows;
  [[nodiscard]] std::int32_t count() const { return static_cast<std::int32_t>(begin.size()) - 1; }
};

/// A symmetric matrix of blocks in its order of elimination.
struct Elimination {
  std::vector<std::int32_t> place;  ///< of each point
  BlockPattern pattern;
  /// Of each entry of the pattern off its diagonal: its edge, or ~ the edge whose block stands
  /// there transposed.
  std::vector<std::int32_t> edge;
};

/// Order of few fill-ins for a graph of `count` points, by least degree [Amestoy1996], in a
/// postorder of the elimination tree, so that columns with the same rows stand together.
/// @param edges  pairs of points, first > second, none twice
[[nodiscard]] Elimination eliminationOf(
    std::int32_t count, std::span<const std::pair<std::int32_t, std::int32_t>> edges);

/// Cholesky factorisation of a sparse symmetric positive definite matrix of Size x Size blocks by
/// the multifrontal method with supernodes [Duff1983, Liu1992]: columns with like rows are
/// eliminated together in one dense front, and what remains of it is added to the front of their
/// parent.
///
/// Disjoint branches of fronts run on several threads, large fronts above them are cut into tiles.
/// Which number is added to which and when depends on the pattern only, so that results do not
/// depend on the number of threads.
template <int Size>
class BlockCholesky {
 public:
  using Block = Eigen::Matrix<double, Size, Size>;

  /// Finds the fronts; the pattern should be that of an elimination.
  void analyse(const BlockPattern& pattern);

  /// @param blocks  one block per entry of the pattern
  /// @return false if the matrix is not positive definite to working precision
  [[nodiscard]] bool factorise(const BlockPattern& pattern, std::span<const Block> blocks);

  /// Replaces the right side (Size * N) by the solution.
  void solve(Eigen::VectorXd& x) const;

  /// Numbers in the factor, zeros of joined supernodes included.
  [[nodiscard]] std::int64_t factorSize() const { return factorSize_; }

 private:
  struct Front {
    std::int32_t first = 0;  ///< block columns first ... first + columns - 1 are eliminated
    std::int32_t columns = 0;
    std::int32_t rowsBegin = 0;  ///< its block rows below, in rows_ and their places in parentRow_
    std::int32_t rowsEnd = 0;
    std::int32_t parent = -1;
    std::int64_t factorBegin = 0;  ///< of its height x width columns in factor_
    double work = 0;               ///< of the subtree
    [[nodiscard]] std::int32_t below() const { return rowsEnd - rowsBegin; }
    [[nodiscard]] Eigen::Index width() const { return Size * static_cast<Eigen::Index>(columns); }
    [[nodiscard]] Eigen::Index height() const {
      return width() + Size * static_cast<Eigen::Index>(below());
    }
  };

  void findFronts(const BlockPattern& pattern);
  void findRows(const BlockPattern& pattern);
  void schedule();
  bool eliminate(std::int32_t f, const BlockPattern& pattern, std::span<const Block> blocks,
                 bool tiled);
  bool eliminateSubtree(std::int32_t root, const BlockPattern& pattern,
                        std::span<const Block> blocks);
  bool eliminateBranch(std::int32_t root, const BlockPattern& pattern,
                       std::span<const Block> blocks);

  /// What a subtree takes off the right side of a row above it.
  struct Taken {
    std::int32_t row;
    Eigen::Matrix<double, Size, 1> value;
  };
  [[nodiscard]] Eigen::Map<const Eigen::MatrixXd> columnsOf(const Front& front) const {
    return {factor_.data() + front.factorBegin, front.height(), front.width()};
  }
  void solveForward(const Front& front, Eigen::VectorXd& x, Eigen::VectorXd& below) const;
  void solveBackward(const Front& front, bool tiled, Eigen::VectorXd& x) const;
  void solveSubtree(std::int32_t root, Eigen::VectorXd& x, std::vector<Taken>& above) const;

  std::vector<Front> fronts_;
  std::vector<std::int32_t> rows_;
  std::vector<std::int32_t> parentRow_;  ///< place of each of rows_ in the parent's front
  std::vector<std::vector<std::int32_t>> children_;
  std::vector<std::int32_t> subtrees_;        ///< roots of those that run each on one thread
  std::vector<std::int32_t> firstOfSubtree_;  ///< of each front: its first descendant
  std::vector<std::int32_t> top_;             ///< the fronts above them, children first
  std::vector<std::int32_t> roots_;           ///< fronts without a parent
  std::vector<char> isTop_;                   ///< of each front: whether it is one of top_
  std::vector<double> factor_;
  std::vector<Eigen::MatrixXd> updates_;  ///< of fronts whose parent is still to come
  std::int64_t factorSize_ = 0;
  double operations_ = 0;
};

extern template class BlockCholesky<1>;
extern template class BlockCholesky<2>;
extern template class BlockCholesky<3>;

}  // namespace explica::geometry
