// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/Measures.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Surface/TopologyCorrection.h"

#include <algorithm>
#include <cmath>

namespace explica::surface {

Eigen::VectorXd meanCurvature(const TriangleMesh& mesh, int smoothing) {
  const Eigen::SparseMatrix<double> laplacian = geometry::cotangentLaplacian(mesh);
  const Eigen::VectorXd areas = geometry::vertexAreas(mesh);
  const Positions normals = geometry::vertexNormals(mesh);
  const Eigen::MatrixXd product = laplacian * mesh.positions;
  Eigen::VectorXd curvature(mesh.vertexCount());
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    // L is positive semi-definite: -L x / area = Laplacian of position = 2 H n.
    curvature[v] = areas[v] > 0 ? -0.5 * product.row(v).dot(normals.row(v)) / areas[v] : 0;
  }
  const auto topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  for (int pass = 0; pass < smoothing; ++pass) {
    Eigen::VectorXd next(curvature.size());
    for (Eigen::Index v = 0; v < next.size(); ++v) {
      double sum = areas[v] * curvature[v], weight = areas[v];
      for (const std::int32_t w : topology.vertexVertices[v]) {
        sum += areas[w] * curvature[w];
        weight += areas[w];
      }
      next[v] = weight > 0 ? sum / weight : 0;
    }
    curvature = std::move(next);
  }
  return curvature;
}

Eigen::VectorXd depthBelowHull(const LevelSet& tissue, const Positions& points, double radius) {
  // Closing by distances: what is farther than `radius` from all that is farther than `radius`
  // from the tissue.
  const Grid& grid = tissue.grid;
  Volume<std::uint8_t> mask(grid);
  for (std::size_t v = 0; v < mask.size(); ++v) mask[v] = tissue[v] > 0;
  VoxelBox box;
  for (int a = 0; a < 3; ++a) {
    const int margin = static_cast<int>(std::ceil(radius / grid.spacing[a])) + 2;
    box.low[a] = -margin;
    box.size[a] = grid.size[a] + 2 * margin;
  }
  mask = crop(mask, box);
  const Volume<float> outward = distanceTo(mask, 1);
  for (std::size_t v = 0; v < mask.size(); ++v) mask[v] = outward[v] > radius;
  const Volume<float> inward = distanceTo(mask, 1);
  Eigen::VectorXd depth(points.rows());
  parallelFor(points.rows(), 4096, [&](std::size_t v) {
    depth[v] = std::max(0.0, sample(inward, points.row(v).transpose()).value - radius);
  });
  return depth;
}

}  // namespace explica::surface
