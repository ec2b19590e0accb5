// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Sampling/Transfer.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/FaceTree.h"

#include <Eigen/Geometry>

#include <cmath>

namespace explica::sampling {
namespace {

/// Barycentric coordinates of a point of the triangle; a face without area gives all to its nearest
/// corner.
Eigen::RowVector3d weightsOf(const TriangleMesh& mesh, std::int32_t face, const Point& x) {
  const Point a = mesh.corner(face, 0), b = mesh.corner(face, 1), c = mesh.corner(face, 2);
  const Vector normal = (b - a).cross(c - a);
  const double area = normal.squaredNorm();
  Eigen::RowVector3d weights;
  if (area > 0) {
    weights << (c - b).cross(x - b).dot(normal), (a - c).cross(x - c).dot(normal),
        (b - a).cross(x - a).dot(normal);
    weights = (weights / area).cwiseMax(0.0);
    return weights / weights.sum();
  }
  int nearest = 0;
  Eigen::RowVector3d((x - a).norm(), (x - b).norm(), (x - c).norm()).minCoeff(&nearest);
  weights.setZero();
  weights[nearest] = 1;
  return weights;
}

}  // namespace

NearestOnSurface nearestOn(const TriangleMesh& surface, const Positions& points) {
  if (surface.faceCount() == 0) throw InvalidInput("surface: it has no faces");
  if (!points.allFinite()) throw InvalidInput("points: one is not finite");
  const geometry::FaceTree tree(surface);
  NearestOnSurface nearest;
  nearest.corners.resize(points.rows(), 3);
  nearest.weights.resize(points.rows(), 3);
  nearest.distance.resize(points.rows());
  constexpr std::size_t kGrain = 256;  // elements a task
  parallelFor(static_cast<std::size_t>(points.rows()), kGrain, [&](std::size_t p) {
    const auto row = static_cast<Eigen::Index>(p);
    const geometry::ClosestPoint found = tree.closestPoint(points.row(row).transpose());
    nearest.corners.row(row) = surface.faces.row(found.face);
    nearest.weights.row(row) = weightsOf(surface, found.face, found.point);
    nearest.distance[row] = std::sqrt(found.squaredDistance);
  });
  return nearest;
}

}  // namespace explica::sampling
