// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/BlockCholesky.h"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <vector>

namespace explica::geometry {

/// Newton's system of an energy that is a sum over faces, two unknowns a vertex: a symmetric matrix
/// of 2 x 2 blocks at vertices and edges, and the gradient.
class FaceSystem {
 public:
  /// What one face adds, with respect to its corners x0 y0 x1 y1 x2 y2.
  struct Term {
    Eigen::Matrix<double, 6, 1> gradient;
    Eigen::Matrix<double, 6, 6> hessian;
  };

  /// @param faces  F x 3; vertices of no face have no unknowns
  FaceSystem(const Faces& faces, Eigen::Index vertexCount);

  /// Matrix and gradient become the sum of term(face).  Terms are computed on several threads and
  /// added in the order of the faces.
  void assemble(const std::function<Term(Eigen::Index face)>& term);

  [[nodiscard]] auto gradientAt(std::int32_t vertex) {
    return gradient_.segment<2>(2 * place_[vertex]);
  }
  [[nodiscard]] Eigen::Matrix2d& diagonalAt(std::int32_t vertex) {
    return blocks_[pattern_.begin[place_[vertex]]];
  }
  /// Adds this share of the diagonal's mean to it.
  void damp(double share);

  /// Newton's step, -matrix^-1 gradient.
  /// @return false if the matrix is not positive definite to working precision
  [[nodiscard]] bool solve();
  [[nodiscard]] Eigen::Vector2d stepAt(std::int32_t vertex) const {
    return step_.segment<2>(2 * place_[vertex]);
  }
  /// -gradient . step: twice the decrease that the quadratic model expects.
  [[nodiscard]] double promised() const { return -gradient_.dot(step_); }

  [[nodiscard]] const std::vector<std::int32_t>& vertices() const { return used_; }

 private:
  /// Where a face's six blocks are in the matrix: corners 00, 11, 22, 10, 20, 21.
  struct FaceBlocks {
    std::array<std::int32_t, 6> at;
    std::array<bool, 6> turned;  ///< the block's transpose belongs there
  };
  void findBlocks();
  [[nodiscard]] std::int32_t slot(std::int32_t row, std::int32_t column) const;

  Faces faces_;
  std::vector<std::int32_t> used_;   ///< vertices of a face, ascending
  std::vector<std::int32_t> place_;  ///< of each vertex in the elimination order, or -1
  BlockPattern pattern_;
  std::vector<Eigen::Matrix2d> blocks_;  ///< of the pattern's entries
  std::vector<FaceBlocks> faceBlocks_;
  Eigen::VectorXd gradient_, step_;
  BlockCholesky<2> cholesky_;
};

}  // namespace explica::geometry
