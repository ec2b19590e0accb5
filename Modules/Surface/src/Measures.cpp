// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/Measures.h"

#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Surface/LevelSet.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace explica::surface {

double radiusOfVoxels(std::int64_t count, const Grid& grid) {
  // Counted in the finest spacing, so that the unit of length changes no bit.
  const double unit = voxelSize(grid);
  const double volume = static_cast<double>(count) * (grid.spacing / unit).prod();
  return unit * std::cbrt(3 * volume / (4 * kPi));
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

}  // namespace explica::surface
