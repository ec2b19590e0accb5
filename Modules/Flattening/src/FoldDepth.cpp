// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Flattening/FoldDepth.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/StopScope.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"

#include <Eigen/IterativeLinearSolvers>

#include <queue>
#include <utility>

namespace explica::flattening {
namespace {

constexpr double kSmoothingShare = 1.0 / 700;  // of the area: t, mm^2
constexpr double kSolverTolerance = 1e-4;      // of the right side; a depth is used by its order

/// Fields on the vertices after one implicit step of the heat equation over time t, V x 3.
Positions smoothed(const TriangleMesh& mesh, const Positions& field) {
  const Eigen::VectorXd areas = geometry::vertexAreas(mesh);
  const double total = areas.sum();
  if (!(total > 0)) throw InvalidInput("surface: it has no area");
  Eigen::SparseMatrix<double> system =
      (kSmoothingShare * total) * geometry::cotangentLaplacian(mesh);
  // Vertices of no face have no area; they stay where they are.
  const double least = 1e-12 * total;
  const Eigen::VectorXd mass = areas.cwiseMax(least);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) system.coeffRef(v, v) += mass[v];
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver;
  solver.setTolerance(kSolverTolerance);
  solver.compute(system);
  Positions result(field.rows(), 3);
  for (int k = 0; k < 3; ++k) {
    checkpoint();
    const Eigen::VectorXd start = field.col(k);
    result.col(k) = solver.solveWithGuess(mass.cwiseProduct(start), start);
  }
  return result;
}

}  // namespace

Eigen::VectorXd foldDepth(const TriangleMesh& mesh) {
  const Positions centred = mesh.positions.rowwise() - mesh.positions.colwise().mean();
  const Positions way = smoothed(mesh, centred) - centred;
  Eigen::VectorXd depth = way.cwiseProduct(geometry::vertexNormals(mesh)).rowwise().sum();
  const Eigen::VectorXd areas = geometry::vertexAreas(mesh);
  depth.array() -= areas.dot(depth) / areas.sum();
  const double deviation = std::sqrt(areas.dot(depth.cwiseAbs2()) / areas.sum());
  if (deviation > 0) depth /= deviation;
  return depth;
}

std::vector<bool> flattestPlace(const TriangleMesh& mesh, double areaShare) {
  const Eigen::VectorXd level = smoothed(mesh, geometry::vertexNormals(mesh)).rowwise().norm();
  const Eigen::VectorXd areas = geometry::vertexAreas(mesh);
  const auto topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  std::vector<bool> place(static_cast<std::size_t>(mesh.vertexCount()), false), seen = place;
  Eigen::Index first = 0;
  (void)level.maxCoeff(&first);
  std::priority_queue<std::pair<double, std::int32_t>> next;
  next.emplace(level[first], static_cast<std::int32_t>(first));
  seen[first] = true;
  for (double wanted = areaShare * areas.sum(); wanted > 0 && !next.empty();) {
    const std::int32_t v = next.top().second;
    next.pop();
    place[v] = true;
    wanted -= areas[v];
    for (const std::int32_t w : topology.vertexVertices[v]) {
      if (seen[w]) continue;
      seen[w] = true;
      next.emplace(level[w], w);
    }
  }
  return place;
}

}  // namespace explica::flattening
