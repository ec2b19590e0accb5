// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/GlobalMeasures.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

#include <Eigen/Geometry>

#include <cmath>
#include <string>

namespace explica::visibility {
namespace {

constexpr std::size_t kMeasureGrain = 64;  // elements a task

struct Centroids {
  Positions point;   // F x 3
  Positions vector;  // F x 3: outward normals as long as the areas
};

Centroids centroidsOf(const TriangleMesh& mesh) {
  Centroids result{Positions(mesh.faceCount(), 3), Positions(mesh.faceCount(), 3)};
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    const Point a = mesh.corner(f, 0);
    const Point b = mesh.corner(f, 1);
    const Point c = mesh.corner(f, 2);
    result.point.row(f) = (a + b + c) / 3;
    result.vector.row(f) = (b - a).cross(c - a) / 2;
  }
  return result;
}

}  // namespace

double hiddenViewingArea(const TriangleMesh& mesh, const Point& centre, double radius) {
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    if (!((mesh.positions.row(v).transpose() - centre).norm() < radius)) {
      throw InvalidInput("viewing sphere: vertex " + std::to_string(v) +
                         " is not inside the sphere of radius " + std::to_string(radius) +
                         " mm: choose a larger radius");
    }
  }
  const Centroids faces = centroidsOf(mesh);
  const auto count = static_cast<std::size_t>(mesh.faceCount());
  return parallelSum(count, kMeasureGrain, 0.0, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Vector x = faces.point.row(i).transpose() - centre;
      double seen = 0;
      for (std::size_t j = 0; j < count; ++j) {
        if (j == i) continue;
        const Vector d = (faces.point.row(j) - faces.point.row(i)).transpose();
        const double distance = d.norm();
        const double along = x.dot(d) / distance;
        // The sphere is left where |x + t w| = r.
        const double root = std::sqrt(along * along + radius * radius - x.squaredNorm());
        const double t = root - along;
        seen += t * t * radius / root * faces.vector.row(j).dot(d.transpose()) /
                (distance * distance * distance);
      }
      sum += seen * faces.vector.row(i).norm();
    }
    return sum;
  });
}

double selfOcclusion(const TriangleMesh& mesh) {
  const Centroids faces = centroidsOf(mesh);
  const Eigen::VectorXd areas = faces.vector.rowwise().norm();
  const auto count = static_cast<std::size_t>(mesh.faceCount());
  return parallelSum(count, kMeasureGrain, 0.0, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      double hidden = 0;
      for (std::size_t j = 0; j < count; ++j) {
        const Vector d = (faces.point.row(j) - faces.point.row(i)).transpose();
        const bool before = faces.vector.row(i).dot(d.transpose()) > 0;
        const bool facing = faces.vector.row(j).dot(d.transpose()) < 0;
        if (before && facing) hidden += areas[static_cast<Eigen::Index>(j)];
      }
      sum += hidden * areas[static_cast<Eigen::Index>(i)];
    }
    return sum;
  });
}

}  // namespace explica::visibility
