// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "MapSolver.h"

#include "Explica/Core/Parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace explica::flattening {
namespace {

constexpr double kSufficient = 1e-4;     // of the decrease that the gradient promises [Armijo1966]
constexpr double kDamping = 1e-7;        // of the mean diagonal: holds translation and rotation
constexpr double kRounding = 1e-14;      // decrease that the energy, a difference of ones, can tell
constexpr double kContactWeight = 1e-4;  // energy of one touching pair over that of one unit strain

/// Corners that the blocks of FaceBlocks belong to.
constexpr std::array<std::array<int, 2>, 6> kCorners = {
    {{0, 0}, {1, 1}, {2, 2}, {1, 0}, {2, 0}, {2, 1}}};

double meanLength(const IntrinsicMesh& mesh) {
  return mesh.lengths.mean();
}

std::vector<double> rimLengths(const IntrinsicMesh& mesh, const Loop& rim) {
  std::vector<std::int32_t> next(static_cast<std::size_t>(mesh.vertexCount), -1);
  std::vector<double> length(next.size(), 0);
  for (std::size_t n = 0; n < rim.size(); ++n) next[rim[n]] = rim[(n + 1) % rim.size()];
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t v = mesh.faces(f, k);
      if (next[v] == mesh.faces(f, (k + 1) % 3)) length[v] = mesh.lengths(f, k);
    }
  }
  std::vector<double> along;
  for (const std::int32_t v : rim) along.push_back(length[v]);
  return along;
}

}  // namespace

MapSolver::MapSolver(const IntrinsicMesh& mesh, const Loop& rim, double areaWeight,
                     double contactRange, std::vector<double> faceWeights)
    : energy_(mesh, areaWeight, 1e-3 * meanLength(mesh), std::move(faceWeights)),
      contact_(rim, rimLengths(mesh, rim), contactRange * meanLength(mesh)) {
  place_.assign(static_cast<std::size_t>(mesh.vertexCount), -1);
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) place_[mesh.faces(f, k)] = 0;
  }
  for (std::size_t v = 0; v < place_.size(); ++v) {
    if (place_[v] < 0) continue;
    place_[v] = static_cast<std::int32_t>(used_.size());
    used_.push_back(static_cast<std::int32_t>(v));
  }
  buildPattern();
}

std::int32_t MapSolver::slot(std::int32_t row, std::int32_t column) const {
  const auto begin = pattern_.rows.begin() + pattern_.begin[column];
  const auto end = pattern_.rows.begin() + pattern_.begin[column + 1];
  return static_cast<std::int32_t>(std::lower_bound(begin, end, row) - pattern_.rows.begin());
}

void MapSolver::buildPattern() {
  const auto count = static_cast<std::int32_t>(used_.size());
  const Faces& faces = energy_.faces();
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t a = place_[faces(f, k)], b = place_[faces(f, (k + 1) % 3)];
      edges.emplace_back(std::max(a, b), std::min(a, b));
    }
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  const auto order = geometry::eliminationPlaces(count, edges);
  for (const std::int32_t v : used_) place_[v] = order[place_[v]];

  for (auto& [a, b] : edges) {
    const auto [low, high] = std::minmax(order[a], order[b]);
    std::tie(a, b) = std::pair{low, high};
  }
  for (std::int32_t n = 0; n < count; ++n) edges.emplace_back(n, n);
  std::sort(edges.begin(), edges.end());
  pattern_.begin.assign(static_cast<std::size_t>(count) + 1, 0);
  for (const auto& [column, row] : edges) {
    ++pattern_.begin[column + 1];
    pattern_.rows.push_back(row);
  }
  std::partial_sum(pattern_.begin.begin(), pattern_.begin.end(), pattern_.begin.begin());
  blocks_.resize(pattern_.rows.size());
  faceBlocks_.resize(static_cast<std::size_t>(faces.rows()));
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (std::size_t n = 0; n < kCorners.size(); ++n) {
      const std::int32_t i = place_[faces(f, kCorners[n][0])], j = place_[faces(f, kCorners[n][1])];
      faceBlocks_[f].at[n] = slot(std::max(i, j), std::min(i, j));
      faceBlocks_[f].turned[n] = i < j;
    }
  }
  cholesky_.analyse(pattern_);
}

double MapSolver::value(const FlatPositions& flat) const {
  return energy_.value(flat) + kContactWeight * contact_.value(flat);
}

void MapSolver::addFaces(const FlatPositions& flat, Eigen::VectorXd& gradient) {
  const Faces& faces = energy_.faces();
  constexpr std::size_t kBlock = 8192;  // faces whose terms are held at a time
  std::vector<MapEnergy::FaceTerm> terms(std::min<std::size_t>(kBlock, faceBlocks_.size()));
  for (std::size_t begin = 0; begin < faceBlocks_.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, faceBlocks_.size() - begin);
    parallelFor(count, 512, [&](std::size_t n) {
      terms[n] = energy_.faceTerm(flat, static_cast<Eigen::Index>(begin + n), true);
    });
    for (std::size_t n = 0; n < count; ++n) {
      const FaceBlocks& to = faceBlocks_[begin + n];
      for (int k = 0; k < 3; ++k) {
        gradient.segment<2>(2 * place_[faces(static_cast<Eigen::Index>(begin + n), k)]) +=
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

void MapSolver::addContacts(const FlatPositions& flat, Eigen::VectorXd& gradient) {
  for (const RimContact::Pair& pair : contact_.near(flat)) {
    const RimContact::PairTerm term = contact_.term(flat, pair);
    for (int k = 0; k < 3; ++k) {
      const std::int32_t place = place_[term.vertices[k]];
      const Eigen::Vector2d d = term.direction.segment<2>(2 * k);
      gradient.segment<2>(2 * place) += kContactWeight * term.gradient.segment<2>(2 * k);
      // Three times the diagonal blocks of the pair's rank-one matrix are above it, and need no
      // place for the vertex and the far edge.
      blocks_[pattern_.begin[place]] += 3 * kContactWeight * term.bend * d * d.transpose();
    }
  }
}

void MapSolver::assemble(const FlatPositions& flat, Eigen::VectorXd& gradient) {
  std::fill(blocks_.begin(), blocks_.end(), Eigen::Matrix2d::Zero());
  gradient.setZero(2 * static_cast<Eigen::Index>(used_.size()));
  addFaces(flat, gradient);
  addContacts(flat, gradient);
  double mean = 0;
  const auto count = static_cast<std::int32_t>(used_.size());
  for (std::int32_t n = 0; n < count; ++n) mean += blocks_[pattern_.begin[n]].trace() / 2;
  mean /= count;
  for (std::int32_t n = 0; n < count; ++n) {
    blocks_[pattern_.begin[n]].diagonal().array() += kDamping * mean;
  }
}

MapSolver::Run MapSolver::lower(FlatPositions& flat, int maxIterations, double tolerance,
                                const Monitor& monitor, const std::function<void(int)>& taken) {
  Run run;
  run.energy = value(flat);
  run.termination = Termination::MaxIterations;
  Eigen::VectorXd gradient;
  FlatPositions step = FlatPositions::Zero(flat.rows(), 2);
  while (run.iterations < maxIterations) {
    if (monitor.shouldStop()) {
      run.termination = Termination::Interrupted;
      break;
    }
    assemble(flat, gradient);
    if (!cholesky_.factorise(pattern_, blocks_)) {
      run.termination = Termination::Stalled;
      break;
    }
    Eigen::VectorXd solved = gradient;
    cholesky_.solve(solved);
    const double promised = gradient.dot(solved);
    if (promised <= std::max(tolerance * run.energy, kRounding)) {
      run.termination = Termination::Converged;
      break;
    }
    for (const std::int32_t v : used_) {
      step.row(v) = -solved.segment<2>(2 * place_[v]).transpose();
    }
    double share = energy_.largestStep(flat, step);
    share = std::min(share, contact_.largestStep(flat, share * step) * share);
    bool moved = false;
    for (int halving = 0; halving < 30; ++halving, share /= 2) {
      const FlatPositions tried = flat + share * step;
      const double energy = value(tried);
      if (!(energy <= run.energy - kSufficient * share * promised)) continue;
      flat = tried;
      run.energy = energy;
      moved = true;
      break;
    }
    ++run.iterations;
    if (!moved) {
      run.termination = Termination::Stalled;
      break;
    }
    if (taken) taken(run.iterations);
  }
  return run;
}

}  // namespace explica::flattening
