// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "MapSolver.h"

#include <algorithm>

namespace explica::flattening {
namespace {

constexpr double kDamping = 1e-7;        // of the mean diagonal: holds translation and rotation
constexpr double kRounding = 1e-14;      // decrease that the energy, a difference of ones, can tell
constexpr double kContactWeight = 1e-4;  // energy of one touching pair over that of one unit strain

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
      contact_(rim, rimLengths(mesh, rim), contactRange * meanLength(mesh)),
      system_(mesh.faces, mesh.vertexCount) {}

double MapSolver::value(const FlatPositions& flat) const {
  return energy_.value(flat) + kContactWeight * contact_.value(flat);
}

void MapSolver::addContacts(const FlatPositions& flat) {
  for (const RimContact::Pair& pair : contact_.near(flat)) {
    const RimContact::PairTerm term = contact_.term(flat, pair);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d d = term.direction.segment<2>(2 * k);
      system_.gradientAt(term.vertices[k]) += kContactWeight * term.gradient.segment<2>(2 * k);
      // Three times the diagonal blocks of the pair's rank-one matrix are above it, and need no
      // place for the vertex and the far edge.
      system_.diagonalAt(term.vertices[k]) += 3 * kContactWeight * term.bend * d * d.transpose();
    }
  }
}

void MapSolver::assemble(const FlatPositions& flat) {
  system_.assemble([&](Eigen::Index f) {
    const MapEnergy::FaceTerm term = energy_.faceTerm(flat, f, true);
    return geometry::FaceSystem::Term{term.gradient, term.hessian};
  });
  addContacts(flat);
  system_.damp(kDamping);
}

bool MapSolver::findStep(const FlatPositions& flat) {
  assemble(flat);
  if (!system_.solve()) return false;
  step_.setZero(flat.rows(), 2);
  for (const std::int32_t v : system_.vertices()) step_.row(v) = system_.stepAt(v).transpose();
  return true;
}

double MapSolver::largestShare(const FlatPositions& flat) const {
  const double share = energy_.largestStep(flat, step_);
  return std::min(share, contact_.largestStep(flat, share * step_) * share);
}

geometry::Descent MapSolver::lower(FlatPositions& flat, int maxIterations, double tolerance,
                                   const Monitor& monitor, const std::function<void(int)>& taken) {
  return geometry::lowerByNewton(*this, flat, {maxIterations, tolerance, kRounding}, monitor,
                                 taken);
}

}  // namespace explica::flattening
