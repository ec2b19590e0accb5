// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/Measures.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Surface/TopologyCorrection.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace explica::surface {
namespace {

/// The closing ball's radius in radii of the ball that has the tissue's volume: 10 mm for a human
/// hemisphere.
constexpr double kHullShare = 0.2;

}  // namespace

double radiusOfVoxels(std::int64_t count, const Grid& grid) {
  // Counted in the finest spacing, so that the unit of length changes no bit.
  const double unit = grid.spacing.minCoeff();
  const double volume = static_cast<double>(count) * (grid.spacing / unit).prod();
  return unit * std::cbrt(3 * volume / (4 * kPi));
}

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

Eigen::VectorXd meanOverSurroundings(const TriangleMesh& mesh, const Eigen::VectorXd& values) {
  const Eigen::VectorXd areas = geometry::faceAreas(mesh);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(values.size()), weight = sum;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const Eigen::Vector3d at = values(mesh.faces.row(f));
    if ((at.array() == 0).any()) continue;
    // The integral of a linear function times the corner's hat function over that of the latter.
    for (int c = 0; c < 3; ++c) {
      sum[mesh.faces(f, c)] += areas[f] * (at.sum() + at[c]) / 4;
      weight[mesh.faces(f, c)] += areas[f];
    }
  }
  return (weight.array() > 0).select(sum.array() / weight.array(), values.array());
}

Evenness evennessOf(const TriangleMesh& mesh) {
  const auto topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  const auto normalOf = [&](Eigen::Index f) -> Vector {
    return (mesh.corner(f, 1) - mesh.corner(f, 0)).cross(mesh.corner(f, 2) - mesh.corner(f, 0));
  };
  Evenness found;
  found.leastFace = kInfinity;
  Eigen::Index edges = 0, sharp = 0;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const Vector normal = normalOf(f);
    found.leastFace = std::min(found.leastFace, 0.5 * normal.norm());
    for (int c = 0; c < 3; ++c) {
      const std::int32_t a = mesh.faces(f, c), b = mesh.faces(f, (c + 1) % 3);
      if (a > b) continue;
      found.longestEdge =
          std::max(found.longestEdge, (mesh.positions.row(a) - mesh.positions.row(b)).norm());
      ++edges;
      for (const std::int32_t g : topology.vertexFaces[a]) {
        if (g == f || (mesh.faces.row(g).array() != b).all()) continue;
        const Vector other = normalOf(g);
        sharp += normal.dot(other) < 0.5 * normal.norm() * other.norm();
      }
    }
  }
  found.dihedralAbove60 = edges > 0 ? static_cast<double>(sharp) / static_cast<double>(edges) : 0;
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const auto& ring = topology.vertexVertices[v];
    Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
    for (const std::int32_t w : ring) mean += mesh.positions.row(w);
    mean /= static_cast<double>(std::max<std::size_t>(1, ring.size()));
    found.highestSpike = std::max(found.highestSpike, (mesh.positions.row(v) - mean).norm());
  }
  return found;
}

Eigen::VectorXd depthBelowHull(const LevelSet& tissue, const Positions& points,
                               std::optional<double> wanted) {
  // Closing by distances: what is farther than `radius` from all that is farther than `radius`
  // from the tissue.
  const Grid& grid = tissue.grid;
  Volume<std::uint8_t> mask(grid);
  for (std::size_t v = 0; v < mask.size(); ++v) mask[v] = tissue[v] > 0;
  const auto voxels = std::count(mask.data.begin(), mask.data.end(), std::uint8_t{1});
  const double radius = wanted.value_or(kHullShare * radiusOfVoxels(voxels, grid));
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
