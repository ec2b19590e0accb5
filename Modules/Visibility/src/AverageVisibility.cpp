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

using FaceCorners = std::array<Point, 3>;

FaceCorners cornersOf(const Positions& positions, const Faces& faces, Eigen::Index face) {
  return {positions.row(faces(face, 0)).transpose(), positions.row(faces(face, 1)).transpose(),
          positions.row(faces(face, 2)).transpose()};
}

Vector twiceAreaVector(const FaceCorners& at) {
  return (at[1] - at[0]).cross(at[2] - at[0]);
}

/// Distance of the viewpoint from a face's centroid, in longest edges of that face, from which the
/// three-point rule replaces the closed form: both then err by about 1e-9 of the flux.
constexpr double kFarRatio = 300;

bool isFar(const FaceCorners& at, const Point& viewpoint) {
  const double squaredEdge = std::max({(at[1] - at[0]).squaredNorm(), (at[2] - at[1]).squaredNorm(),
                                       (at[0] - at[2]).squaredNorm()});
  return ((at[0] + at[1] + at[2]) / 3 - viewpoint).squaredNorm() >
         kFarRatio * kFarRatio * squaredEdge;
}

/// Flux of a face, averaged over the viewpoints.
FaceFlux meanFlux(const FaceCorners& at, const Viewpoints& viewpoints) {
  FaceFlux sum{.gradient = {Vector::Zero(), Vector::Zero(), Vector::Zero()}};
  for (std::size_t p = 0; p < viewpoints.points.size(); ++p) {
    const Point& from = viewpoints.points[p];
    const FaceFlux one = isFar(at, from) ? faceFluxFar(at[0], at[1], at[2], from)
                                         : faceFlux(at[0], at[1], at[2], from);
    sum.flux += viewpoints.weights[p] * one.flux;
    for (int k = 0; k < 3; ++k) sum.gradient[k] += viewpoints.weights[p] * one.gradient[k];
  }
  return sum;
}

}  // namespace

AverageVisibility::AverageVisibility(const Faces& faces,
                                     const std::vector<std::int32_t>& regionFaces,
                                     Viewpoints viewpoints)
    : faces_(static_cast<Eigen::Index>(regionFaces.size()), 3), viewpoints_(std::move(viewpoints)) {
  if (regionFaces.empty()) {
    throw InvalidInput("region: it has no face; choose a larger radius or another centre");
  }
  requireViewpoints(viewpoints_);
  for (std::size_t i = 0; i < regionFaces.size(); ++i) {
    if (regionFaces[i] < 0 || regionFaces[i] >= faces.rows()) {
      throw InvalidInput("region: face " + std::to_string(regionFaces[i]) +
                         " does not exist; the surface has " + std::to_string(faces.rows()));
    }
    faces_.row(i) = faces.row(regionFaces[i]);
  }
}

VisibilityValue AverageVisibility::evaluate(const Positions& positions) const {
  const auto count = static_cast<std::size_t>(faces_.rows());
  std::vector<FaceFlux> fluxes(count);
  Eigen::VectorXd areas(faces_.rows());
  parallelFor(count, kAverageGrain, [&](std::size_t i) {
    const FaceCorners at = cornersOf(positions, faces_, static_cast<Eigen::Index>(i));
    fluxes[i] = meanFlux(at, viewpoints_);
    areas[i] = twiceAreaVector(at).norm() / 2;
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
    const FaceCorners corner = cornersOf(positions, faces_, static_cast<Eigen::Index>(i));
    const double area = areas[i];
    Vector normal = Vector::Zero();
    if (area > 0) normal = twiceAreaVector(corner) / (2 * area);
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
          const FaceCorners at = cornersOf(positions, faces_, static_cast<Eigen::Index>(i));
          part += Sums(meanFlux(at, viewpoints_).flux, twiceAreaVector(at).norm() / 2);
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
    const FaceCorners at = cornersOf(mesh.positions, mesh.faces, static_cast<Eigen::Index>(i));
    fluxes[i] = meanFlux(at, viewpoints).flux;
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
