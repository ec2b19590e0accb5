// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/AverageVisibility.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Visibility/FaceFlux.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <string>

namespace explica::visibility {
namespace {

constexpr std::size_t kAverageGrain = 128;  // faces a task

void requireViewpoints(const Viewpoints& viewpoints) {
  if (viewpoints.points.empty() || viewpoints.points.size() != viewpoints.weights.size()) {
    throw InvalidInput("viewpoints: found " + std::to_string(viewpoints.points.size()) +
                       " points and " + std::to_string(viewpoints.weights.size()) +
                       " weights; as many of both, and at least one, are needed");
  }
}

bool isFar(const Point& a, const Point& b, const Point& c, const Point& viewpoint, double ratio) {
  const double squaredEdge =
      std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
  return ((a + b + c) / 3 - viewpoint).squaredNorm() > ratio * ratio * squaredEdge;
}

/// Flux of a face, averaged over the viewpoints.
FaceFlux meanFlux(const Point& a, const Point& b, const Point& c, const Viewpoints& viewpoints,
                  double farRatio) {
  FaceFlux sum{.gradient = {Vector::Zero(), Vector::Zero(), Vector::Zero()}};
  for (std::size_t p = 0; p < viewpoints.points.size(); ++p) {
    const Point& from = viewpoints.points[p];
    const FaceFlux one =
        isFar(a, b, c, from, farRatio) ? faceFluxFar(a, b, c, from) : faceFlux(a, b, c, from);
    sum.flux += viewpoints.weights[p] * one.flux;
    for (int k = 0; k < 3; ++k) sum.gradient[k] += viewpoints.weights[p] * one.gradient[k];
  }
  return sum;
}

}  // namespace

AverageVisibility::AverageVisibility(const Faces& faces, std::vector<std::int32_t> regionFaces,
                                     Viewpoints viewpoints, const AverageVisibilityOptions& options)
    : faces_(static_cast<Eigen::Index>(regionFaces.size()), 3),
      regionFaces_(std::move(regionFaces)),
      viewpoints_(std::move(viewpoints)),
      options_(options) {
  if (regionFaces_.empty()) {
    throw InvalidInput("region: it has no face; choose a larger radius or another centre");
  }
  requireViewpoints(viewpoints_);
  if (!(options_.farRatio > 0)) throw InvalidInput("far ratio: must be greater than 0");
  for (std::size_t i = 0; i < regionFaces_.size(); ++i) {
    if (regionFaces_[i] < 0 || regionFaces_[i] >= faces.rows()) {
      throw InvalidInput("region: face " + std::to_string(regionFaces_[i]) +
                         " does not exist; the surface has " + std::to_string(faces.rows()));
    }
    faces_.row(i) = faces.row(regionFaces_[i]);
  }
}

VisibilityValue AverageVisibility::evaluate(const Positions& positions) const {
  const auto count = static_cast<std::size_t>(faces_.rows());
  std::vector<FaceFlux> fluxes(count);
  Eigen::VectorXd areas(faces_.rows());
  parallelFor(count, kAverageGrain, [&](std::size_t i) {
    const Point a = positions.row(faces_(i, 0)).transpose();
    const Point b = positions.row(faces_(i, 1)).transpose();
    const Point c = positions.row(faces_(i, 2)).transpose();
    fluxes[i] = meanFlux(a, b, c, viewpoints_, options_.farRatio);
    areas[i] = (b - a).cross(c - a).norm() / 2;
  });

  VisibilityValue result;
  result.faceFlux.resize(faces_.rows());
  double flux = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    flux += fluxes[i].flux;
    result.area += areas[row];
    result.faceFlux[row] = areas[row] > 0 ? fluxes[i].flux / areas[row] : 0;
  }
  if (!(result.area > 0))
    throw InvalidInput("region: its area is zero; its visibility is undefined");
  result.value = flux / result.area;

  result.gradient.setZero(positions.rows(), 3);
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<Point, 3> corner = {positions.row(faces_(i, 0)).transpose(),
                                         positions.row(faces_(i, 1)).transpose(),
                                         positions.row(faces_(i, 2)).transpose()};
    const double area = areas[i];
    Vector normal = Vector::Zero();
    if (area > 0) normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]) / (2 * area);
    for (int k = 0; k < 3; ++k) {
      const Vector areaGradient = normal.cross(corner[(k + 2) % 3] - corner[(k + 1) % 3]) / 2;
      result.gradient.row(faces_(i, k)) +=
          ((fluxes[i].gradient[k] - result.value * areaGradient) / result.area).transpose();
    }
  }
  return result;
}

double AverageVisibility::value(const Positions& positions) const {
  using Sums = Eigen::Array2d;  // flux, area
  const auto count = static_cast<std::size_t>(faces_.rows());
  const Sums sums = parallelSum(
      count, kAverageGrain, Sums(Sums::Zero()), [&](std::size_t begin, std::size_t end) {
        Sums part = Sums::Zero();
        for (std::size_t i = begin; i < end; ++i) {
          const Point a = positions.row(faces_(i, 0)).transpose();
          const Point b = positions.row(faces_(i, 1)).transpose();
          const Point c = positions.row(faces_(i, 2)).transpose();
          part += Sums(meanFlux(a, b, c, viewpoints_, options_.farRatio).flux,
                       (b - a).cross(c - a).norm() / 2);
        }
        return part;
      });
  if (!(sums[1] > 0)) throw InvalidInput("region: its area is zero; its visibility is undefined");
  return sums[0] / sums[1];
}

Eigen::VectorXd vertexFlux(const TriangleMesh& mesh, const Viewpoints& viewpoints) {
  requireViewpoints(viewpoints);
  const auto count = static_cast<std::size_t>(mesh.faceCount());
  std::vector<double> fluxes(count);
  parallelFor(count, kAverageGrain, [&](std::size_t i) {
    const auto f = static_cast<Eigen::Index>(i);
    fluxes[i] = meanFlux(mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2), viewpoints,
                         AverageVisibilityOptions{}.farRatio)
                    .flux;
  });
  Eigen::VectorXd flux = Eigen::VectorXd::Zero(mesh.vertexCount());
  Eigen::VectorXd area = flux;
  const Eigen::VectorXd areas = geometry::faceAreas(mesh);
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      flux[mesh.faces(f, k)] += fluxes[f];
      area[mesh.faces(f, k)] += areas[f];
    }
  }
  for (Eigen::Index v = 0; v < flux.size(); ++v) flux[v] = area[v] > 0 ? flux[v] / area[v] : 0;
  return flux;
}

}  // namespace explica::visibility
