// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Geometry/MeshMeasures.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <vector>

namespace explica::geometry {

Positions faceNormalVectors(const TriangleMesh& mesh) {
  Positions normals(mesh.faceCount(), 3);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const Point a = mesh.corner(f, 0);
    normals.row(f) = (mesh.corner(f, 1) - a).cross(mesh.corner(f, 2) - a).transpose();
  }
  return normals;
}

Eigen::VectorXd faceAreas(const TriangleMesh& mesh) {
  return 0.5 * faceNormalVectors(mesh).rowwise().norm();
}

double totalArea(const TriangleMesh& mesh) {
  return faceAreas(mesh).sum();
}

double enclosedVolume(const TriangleMesh& mesh) {
  if (mesh.faceCount() == 0) return 0;
  const Point reference = mesh.corner(0, 0);  // near the mesh: keeps far-away meshes accurate
  double sixfold = 0;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const Vector a = mesh.corner(f, 0) - reference;
    const Vector b = mesh.corner(f, 1) - reference;
    const Vector c = mesh.corner(f, 2) - reference;
    sixfold += a.dot(b.cross(c));
  }
  return sixfold / 6;
}

bool turnOutward(TriangleMesh& mesh) {
  const bool inward = enclosedVolume(mesh) < 0;
  if (inward) mesh.faces.col(1).swap(mesh.faces.col(2));
  return inward;
}

Eigen::VectorXd vertexAreas(const TriangleMesh& mesh) {
  const Eigen::VectorXd areas = faceAreas(mesh);
  Eigen::VectorXd result = Eigen::VectorXd::Zero(mesh.vertexCount());
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) result[mesh.faces(f, k)] += areas[f] / 3;
  }
  return result;
}

Positions vertexNormals(const TriangleMesh& mesh) {
  const Positions faceNormals = faceNormalVectors(mesh);
  Positions normals = Positions::Zero(mesh.vertexCount(), 3);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) normals.row(mesh.faces(f, k)) += faceNormals.row(f);
  }
  for (Eigen::Index v = 0; v < normals.rows(); ++v) {
    const double length = normals.row(v).norm();
    if (length > 0) normals.row(v) /= length;
  }
  return normals;
}

Eigen::SparseMatrix<double> cotangentLaplacian(const TriangleMesh& mesh) {
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(static_cast<std::size_t>(mesh.faceCount()) * 12);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int i = mesh.faces(f, (k + 1) % 3), j = mesh.faces(f, (k + 2) % 3);
      const Vector u = mesh.corner(f, (k + 1) % 3) - mesh.corner(f, k);
      const Vector v = mesh.corner(f, (k + 2) % 3) - mesh.corner(f, k);
      const double twiceArea = u.cross(v).norm();
      if (twiceArea <= 0) continue;  // a face without area has no gradient to integrate
      const double weight = 0.5 * u.dot(v) / twiceArea;
      triplets.emplace_back(i, i, weight);
      triplets.emplace_back(j, j, weight);
      triplets.emplace_back(i, j, -weight);
      triplets.emplace_back(j, i, -weight);
    }
  }
  Eigen::SparseMatrix<double> laplacian(mesh.vertexCount(), mesh.vertexCount());
  laplacian.setFromTriplets(triplets.begin(), triplets.end());
  return laplacian;
}

double meanEdgeLength(const TriangleMesh& mesh) {
  if (mesh.faceCount() == 0) return 0;
  double sum = 0;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) sum += (mesh.corner(f, (k + 1) % 3) - mesh.corner(f, k)).norm();
  }
  return sum / (3.0 * static_cast<double>(mesh.faceCount()));
}

Eigen::VectorXd smallestAnglesRad(const TriangleMesh& mesh) {
  Eigen::VectorXd angles(mesh.faceCount());
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    double smallest = kPi;
    for (int k = 0; k < 3; ++k) {
      const Vector u = mesh.corner(f, (k + 1) % 3) - mesh.corner(f, k);
      const Vector v = mesh.corner(f, (k + 2) % 3) - mesh.corner(f, k);
      smallest = std::min(smallest, std::atan2(u.cross(v).norm(), u.dot(v)));
    }
    angles[f] = smallest;
  }
  return angles;
}

}  // namespace explica::geometry
