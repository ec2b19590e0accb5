// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/Fixtures.h"

#include "Explica/Geometry/MeshTopology.h"

#include <cmath>

namespace explica::geometry {

TriangleMesh subdivide(const TriangleMesh& mesh) {
  const MeshTopology topology = buildTopology(mesh.faces, mesh.vertexCount());
  const Eigen::Index vertices = mesh.vertexCount();
  TriangleMesh fine;
  fine.positions.resize(vertices + topology.edges.rows(), 3);
  fine.positions.topRows(vertices) = mesh.positions;
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    fine.positions.row(vertices + e) =
        0.5 * (mesh.positions.row(topology.edges(e, 0)) + mesh.positions.row(topology.edges(e, 1)));
  }
  fine.faces.resize(4 * mesh.faceCount(), 3);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const Eigen::RowVector3i corner = mesh.faces.row(f);
    const auto middle = [&](int k) {
      return static_cast<std::int32_t>(vertices + topology.faceEdges(f, k));
    };
    fine.faces.row(4 * f) << corner[0], middle(0), middle(2);
    fine.faces.row(4 * f + 1) << middle(0), corner[1], middle(1);
    fine.faces.row(4 * f + 2) << middle(2), middle(1), corner[2];
    fine.faces.row(4 * f + 3) << middle(0), middle(1), middle(2);
  }
  return fine;
}

TriangleMesh makeIcosphere(int levels, double radius, const Point& centre) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  TriangleMesh mesh;
  mesh.positions.resize(12, 3);
  mesh.positions << -1, g, 0, 1, g, 0, -1, -g, 0, 1, -g, 0,  //
      0, -1, g, 0, 1, g, 0, -1, -g, 0, 1, -g,                //
      g, 0, -1, g, 0, 1, -g, 0, -1, -g, 0, 1;
  mesh.faces.resize(20, 3);
  mesh.faces << 0, 11, 5, 0, 5, 1, 0, 1, 7, 0, 7, 10, 0, 10, 11,  //
      1, 5, 9, 5, 11, 4, 11, 10, 2, 10, 7, 6, 7, 1, 8,            //
      3, 9, 4, 3, 4, 2, 3, 2, 6, 3, 6, 8, 3, 8, 9,                //
      4, 9, 5, 2, 4, 11, 6, 2, 10, 8, 6, 7, 9, 8, 1;
  mesh.positions.rowwise().normalize();
  for (int level = 0; level < levels; ++level) {
    mesh = subdivide(mesh);
    mesh.positions.rowwise().normalize();
  }
  mesh.positions *= radius;
  mesh.positions.rowwise() += centre.transpose();
  return mesh;
}

TriangleMesh makeFoldedSphere(int levels, double radius, double depth, int waves) {
  TriangleMesh mesh = makeIcosphere(levels);
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const Point p = mesh.positions.row(v).transpose();
    // Star-shaped about the centre, so that folds of any depth below 1 cannot meet.
    const double wave = std::sin(waves * p.x() + 1.3 * std::sin(2 * p.z())) *
                        std::sin(waves * p.y() + 1.7 * std::sin(2 * p.x()));
    mesh.positions.row(v) = radius * (1 - depth * (0.5 + 0.5 * wave)) * p.transpose();
  }
  return mesh;
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both;
  both.positions.resize(a.vertexCount() + b.vertexCount(), 3);
  both.positions << a.positions, b.positions;
  both.faces.resize(a.faceCount() + b.faceCount(), 3);
  both.faces << a.faces, (b.faces.array() + static_cast<std::int32_t>(a.vertexCount())).matrix();
  return both;
}

}  // namespace explica::geometry
