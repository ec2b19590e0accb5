// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/FaceSystem.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <numeric>

namespace explica::geometry {
namespace {

/// Corners that the blocks of FaceBlocks belong to.
constexpr std::array<std::array<int, 2>, 6> kCorners = {
    {{0, 0}, {1, 1}, {2, 2}, {1, 0}, {2, 0}, {2, 1}}};

}  // namespace

FaceSystem::FaceSystem(const Faces& faces, Eigen::Index vertexCount)
    : faces_(faces), place_(static_cast<std::size_t>(vertexCount), -1) {
  for (const std::int32_t v : faces_.reshaped()) place_[v] = 0;
  for (std::size_t v = 0; v < place_.size(); ++v) {
    if (place_[v] < 0) continue;
    place_[v] = static_cast<std::int32_t>(used_.size());
    used_.push_back(static_cast<std::int32_t>(v));
  }
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = place_[faces_(f, k)], b = place_[faces_(f, (k + 1) % 3)];
      edges.emplace_back(std::max(a, b), std::min(a, b));
    }
  }
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  Elimination elimination = eliminationOf(static_cast<std::int32_t>(used_.size()), edges);
  for (const std::int32_t v : used_) place_[v] = elimination.place[place_[v]];
  pattern_ = std::move(elimination.pattern);
  findBlocks();
  cholesky_.analyse(pattern_);
}

std::int32_t FaceSystem::slot(std::int32_t row, std::int32_t column) const {
  const auto begin = pattern_.rows.begin() + pattern_.begin[column];
  const auto end = pattern_.rows.begin() + pattern_.begin[column + 1];
  return static_cast<std::int32_t>(std::lower_bound(begin, end, row) - pattern_.rows.begin());
}

void FaceSystem::findBlocks() {
  blocks_.resize(pattern_.rows.size());
  faceBlocks_.resize(static_cast<std::size_t>(faces_.rows()));
  for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
    for (std::size_t n = 0; n < kCorners.size(); ++n) {
      const std::int32_t i = place_[faces_(f, kCorners[n][0])];
      const std::int32_t j = place_[faces_(f, kCorners[n][1])];
      faceBlocks_[f].at[n] = slot(std::max(i, j), std::min(i, j));
      faceBlocks_[f].turned[n] = i < j;
    }
  }
}

void FaceSystem::assemble(const std::function<Term(Eigen::Index)>& term) {
  constexpr std::size_t kBlock = 8192;  // faces whose terms are held at a time
  std::ranges::fill(blocks_, Eigen::Matrix2d::Zero());
  gradient_.setZero(2 * static_cast<Eigen::Index>(used_.size()));
  std::vector<Term> terms(std::min<std::size_t>(kBlock, faceBlocks_.size()));
  for (std::size_t begin = 0; begin < faceBlocks_.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, faceBlocks_.size() - begin);
    parallelFor(count,
                [&](std::size_t n) { terms[n] = term(static_cast<Eigen::Index>(begin + n)); });
    for (std::size_t n = 0; n < count; ++n) {
      const FaceBlocks& to = faceBlocks_[begin + n];
      for (int k = 0; k < 3; ++k) {
        gradientAt(faces_(static_cast<Eigen::Index>(begin + n), k)) +=
            terms[n].gradient.segment<2>(2 * k);
      }
      for (std::size_t m = 0; m < kCorners.size(); ++m) {
        const Eigen::Matrix2d block =
            terms[n].hessian.block<2, 2>(2 * kCorners[m][0], 2 * kCorners[m][1]);
        if (to.turned[m]) {
          blocks_[to.at[m]] += block.transpose();
        } else {
          blocks_[to.at[m]] += block;
        }
      }
    }
  }
}

void FaceSystem::damp(double share) {
  double mean = 0;
  for (const std::int32_t v : used_) mean += diagonalAt(v).trace() / 2;
  mean /= static_cast<double>(used_.size());
  for (const std::int32_t v : used_) diagonalAt(v).diagonal().array() += share * mean;
}

bool FaceSystem::solve() {
  if (!cholesky_.factorise(pattern_, blocks_)) return false;
  step_ = -gradient_;
  cholesky_.solve(step_);
  return true;
}

}  // namespace explica::geometry
