// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "ScaleFactor.h"

#include "Explica/Geometry/SparseCholesky.h"

#include <algorithm>
#include <cmath>

namespace explica::flattening {
namespace {

constexpr double kLeastSine = 1e-3;  // of an angle: the cotangents of needles would drown the rest

/// Angle between sides a and b of a triangle whose third is c.
double angleOf(double a, double b, double c) {
  return std::acos(std::clamp((a * a + b * b - c * c) / (2 * a * b), -1.0, 1.0));
}

}  // namespace

Eigen::VectorXd scaleFactor(const IntrinsicDisc& disc) {
  const IntrinsicMesh& mesh = disc.mesh;
  std::vector<std::int32_t> row(static_cast<std::size_t>(mesh.vertexCount), 0);
  for (const std::int32_t v : disc.rim) row[v] = -1;
  std::int32_t unknowns = 0;
  for (std::int32_t& r : row) r = r < 0 ? -1 : unknowns++;
  Eigen::VectorXd missing = Eigen::VectorXd::Constant(mesh.vertexCount, 2 * kPi);
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      // The angle at corner k lies between edges k and k + 2, opposite edge k + 1.
      const int next = (k + 1) % 3, last = (k + 2) % 3;
      const double angle =
          angleOf(mesh.lengths(f, k), mesh.lengths(f, last), mesh.lengths(f, next));
      missing[mesh.faces(f, k)] -= angle;
      const double weight = 0.5 * std::cos(angle) / std::max(std::sin(angle), kLeastSine);
      const std::int32_t a = row[mesh.faces(f, next)], b = row[mesh.faces(f, last)];
      if (a >= 0) entries.emplace_back(a, a, weight);
      if (b >= 0) entries.emplace_back(b, b, weight);
      if (a < 0 || b < 0) continue;
      entries.emplace_back(a, b, -weight);
      entries.emplace_back(b, a, -weight);
    }
  }
  Eigen::SparseMatrix<double> stiffness(unknowns, unknowns);
  stiffness.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXd right(unknowns);
  for (Eigen::Index v = 0; v < mesh.vertexCount; ++v) {
    if (row[v] >= 0) right[row[v]] = -missing[v];
  }
  // Cotangents of faces without area are rounded: what is no longer definite becomes so by little.
  geometry::SparseCholesky solver(stiffness);
  const double mean = stiffness.diagonal().mean();
  for (double added = 1e-14 * mean; !solver.isDefinite() && added < mean; added *= 10) {
    stiffness.diagonal().array() += added;
    solver.compute(stiffness);
  }
  const Eigen::VectorXd solved = solver.solve(right);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(mesh.vertexCount);
  for (Eigen::Index v = 0; v < mesh.vertexCount; ++v) {
    if (row[v] >= 0) u[v] = solved[row[v]];
  }
  return u;
}

}  // namespace explica::flattening
