// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Two standard flat parameterisations of a patch, for comparison only; written here, not taken from
// a library.
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Geometry/MeshMeasures.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <Eigen/SparseCholesky>

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace explica::unfolding {

/// Corners of a face laid into its own plane: the first at 0, the second on the positive x axis.
inline std::array<Eigen::Vector2d, 3> laidFlat(const TriangleMesh& mesh, Eigen::Index f) {
  const Vector u = mesh.corner(f, 1) - mesh.corner(f, 0), v = mesh.corner(f, 2) - mesh.corner(f, 0);
  const double length = std::max(u.norm(), 1e-300);
  return {Eigen::Vector2d(0, 0), Eigen::Vector2d(length, 0),
          Eigen::Vector2d(u.dot(v) / length, u.cross(v).norm() / length)};
}

/// Least-squares conformal map [Levy2002], scaled to the patch's area: V x 3 with z = 0.
///
/// Minimises  sum_f |grad v - rot90 grad u|^2 A_f  with two vertices fixed that lie far apart.
inline Positions leastSquaresConformalMap(const TriangleMesh& mesh) {
  const Eigen::Index count = mesh.vertexCount();
  Eigen::Index a = 0, b = 0;
  for (int n = 0; n < 2; ++n) {
    (void)(mesh.positions.rowwise() - mesh.positions.row(b)).rowwise().squaredNorm().maxCoeff(&a);
    std::swap(a, b);
  }
  const double apart = (mesh.positions.row(a) - mesh.positions.row(b)).norm();
  std::vector<Eigen::Index> unknown(static_cast<std::size_t>(count), -1);
  Eigen::Index free = 0;
  for (Eigen::Index v = 0; v < count; ++v) {
    if (v != a && v != b) unknown[v] = free++;
  }
  // Rows 2 f and 2 f + 1: real and imaginary part of sum_k (edge opposite k) z_k / sqrt(2 A).
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(2 * mesh.faceCount());
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const auto p = laidFlat(mesh, f);
    const double root = std::sqrt(std::max(p[1].x() * p[2].y(), 1e-12 * p[1].x() * p[1].x()));
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d w = (p[(k + 2) % 3] - p[(k + 1) % 3]) / root;
      const Eigen::Index v = mesh.faces(f, k);
      if (unknown[v] < 0) {
        const double x = v == b ? apart : 0;
        right[2 * f] -= w.x() * x;
        right[2 * f + 1] -= w.y() * x;
        continue;
      }
      entries.emplace_back(2 * f, 2 * unknown[v], w.x());
      entries.emplace_back(2 * f, 2 * unknown[v] + 1, -w.y());
      entries.emplace_back(2 * f + 1, 2 * unknown[v], w.y());
      entries.emplace_back(2 * f + 1, 2 * unknown[v] + 1, w.x());
    }
  }
  Eigen::SparseMatrix<double> system(2 * mesh.faceCount(), 2 * free);
  system.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(system.transpose() * system);
  if (solver.info() != Eigen::Success) throw std::runtime_error("conformal map: singular");
  const Eigen::VectorXd solved = solver.solve(system.transpose() * right);
  Positions flat = Positions::Zero(count, 3);
  flat(b, 0) = apart;
  for (Eigen::Index v = 0; v < count; ++v) {
    if (unknown[v] >= 0) flat.row(v).head<2>() = solved.segment<2>(2 * unknown[v]).transpose();
  }
  return flat * std::sqrt(geometry::totalArea(mesh) / geometry::totalArea({flat, mesh.faces}));
}

/// As rigid as possible [Liu2008]: rotations of faces and a solve for positions in turn, from the
/// conformal map on, until the energy falls by less than `tolerance` of itself.
inline Positions asRigidAsPossibleMap(const TriangleMesh& mesh, double tolerance = 1e-5,
                                      int maxIterations = 500) {
  Positions flat = leastSquaresConformalMap(mesh);
  const Eigen::Index count = mesh.vertexCount();
  constexpr double kLargestCotangent = 100;  // of slivers
  std::vector<std::array<Eigen::Vector2d, 3>> rest;
  std::vector<std::array<double, 3>> cotangents;  // [k]: of the angle opposite the edge k, k + 1
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    rest.push_back(laidFlat(mesh, f));
    cotangents.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d u = rest.back()[k] - rest.back()[(k + 2) % 3];
      const Eigen::Vector2d v = rest.back()[(k + 1) % 3] - rest.back()[(k + 2) % 3];
      const double cotangent = std::clamp(u.dot(v) / (u.x() * v.y() - u.y() * v.x()),
                                          -kLargestCotangent, kLargestCotangent);
      cotangents.back()[k] = cotangent;
      const Eigen::Index i = mesh.faces(f, k), j = mesh.faces(f, (k + 1) % 3);
      entries.emplace_back(i, i, cotangent);
      entries.emplace_back(j, j, cotangent);
      entries.emplace_back(i, j, -cotangent);
      entries.emplace_back(j, i, -cotangent);
    }
  }
  entries.emplace_back(0, 0, 1);  // the first vertex stays
  Eigen::SparseMatrix<double> system(count, count);
  system.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(system);
  if (solver.info() != Eigen::Success) throw std::runtime_error("rigid map: singular");
  double before = 0;
  for (int n = 0; n < maxIterations; ++n) {
    Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, 2);
    right.row(0) = flat.row(0).head<2>();
    double energy = 0;
    for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
      Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
      std::array<Eigen::Vector2d, 3> now, was;
      for (int k = 0; k < 3; ++k) {
        was[k] = rest[f][(k + 1) % 3] - rest[f][k];
        now[k] = (flat.row(mesh.faces(f, (k + 1) % 3)) - flat.row(mesh.faces(f, k)))
                     .head<2>()
                     .transpose();
        covariance += cotangents[f][k] * now[k] * was[k].transpose();
      }
      const Eigen::JacobiSVD<Eigen::Matrix2d> svd(covariance,
                                                  Eigen::ComputeFullU | Eigen::ComputeFullV);
      Eigen::Matrix2d sign = Eigen::Matrix2d::Identity();
      sign(1, 1) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
      const Eigen::Matrix2d rotation = svd.matrixU() * sign * svd.matrixV().transpose();
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector2d edge = rotation * was[k];
        energy += cotangents[f][k] * (now[k] - edge).squaredNorm();
        right.row(mesh.faces(f, (k + 1) % 3)) += cotangents[f][k] * edge.transpose();
        right.row(mesh.faces(f, k)) -= cotangents[f][k] * edge.transpose();
      }
    }
    if (n > 0 && before - energy <= tolerance * std::abs(before)) break;
    before = energy;
    flat.leftCols<2>() = solver.solve(right);
  }
  return flat;
}

/// Faces whose corners run clockwise in the map.
inline std::size_t flippedFaces(const Positions& flat, const Faces& faces) {
  std::size_t flipped = 0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const auto u = flat.row(faces(f, 1)) - flat.row(faces(f, 0));
    const auto v = flat.row(faces(f, 2)) - flat.row(faces(f, 0));
    flipped += u[0] * v[1] - u[1] * v[0] <= 0;
  }
  return flipped;
}

}  // namespace explica::unfolding
