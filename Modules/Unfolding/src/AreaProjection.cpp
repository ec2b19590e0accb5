// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "AreaProjection.h"

#include <Eigen/Geometry>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

namespace explica::unfolding {

int keepAreas(const Patch& patch, const Positions& x, const std::vector<std::int32_t>& unknown,
              Positions& velocity) {
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::Index row = 0;
  for (const PatchFace& face : patch.ofRegion()) {
    const FaceShape shape = shapeOf(face, x);
    for (int k = 0; k < 3; ++k) {
      const std::int32_t u = unknown[face.vertices[k]];
      if (u < 0) continue;
      const Vector slope = shape.area * shape.hat[k];
      for (int axis = 0; axis < 3; ++axis) entries.emplace_back(row, 3 * u + axis, slope[axis]);
    }
    ++row;
  }
  Eigen::Index unknowns = 0;
  for (const std::int32_t u : unknown) unknowns = std::max<Eigen::Index>(unknowns, u + 1);
  Eigen::SparseMatrix<double> jacobian(row, 3 * unknowns);
  jacobian.setFromTriplets(entries.begin(), entries.end());
  Eigen::VectorXd flat = Eigen::VectorXd::Zero(3 * unknowns);
  for (std::size_t v = 0; v < unknown.size(); ++v) {
    if (unknown[v] >= 0) {
      flat.segment<3>(3 * unknown[v]) = velocity.row(static_cast<Eigen::Index>(v)).transpose();
    }
  }
  const Eigen::SparseMatrix<double> normalMatrix = jacobian * jacobian.transpose();
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver;
  solver.setTolerance(1e-8);
  solver.setMaxIterations(2000);
  solver.compute(normalMatrix);
  const Eigen::VectorXd rates = jacobian * flat;
  flat -= jacobian.transpose() * solver.solve(rates);
  for (std::size_t v = 0; v < unknown.size(); ++v) {
    if (unknown[v] >= 0) {
      velocity.row(static_cast<Eigen::Index>(v)) = flat.segment<3>(3 * unknown[v]).transpose();
    }
  }
  return static_cast<int>(solver.iterations());
}

}  // namespace explica::unfolding
