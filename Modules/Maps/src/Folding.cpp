// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Maps/Folding.h"

#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Geometry/MeshTopology.h"
#include "Explica/Maps/HeatFlow.h"
#include "Explica/Maps/Smoothing.h"

#include <algorithm>
#include <cmath>

namespace explica::maps {
namespace {

/// Width of the diffusion of curvature over the square root of the area: 5 mm in a hemisphere of
/// 70,700 mm^2, where the correlation with FreeSurfer's `curv` of OASIS-1 0001 is highest.
constexpr double kCurvatureWidth = 0.0188;

/// Time of the inflation over the area: 200 mm^2 in the same hemisphere, where the correlation with
/// its `sulc` is highest (flat within 2e-3 from 170 to 240 mm^2).
constexpr double kInflationTime = 0.00283;
constexpr int kInflationSteps = 10;  // 20 steps change the depth of fsaverage5 by less than 1e-3

/// Values at boundary vertices replaced by the mean of their neighbours inside.
void fillBoundary(const TriangleMesh& mesh, Eigen::VectorXd& values) {
  const geometry::MeshTopology topology = geometry::buildTopology(mesh.faces, mesh.vertexCount());
  std::vector<bool> rim(static_cast<std::size_t>(mesh.vertexCount()), false);
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    if (topology.edgeFaces(e, 1) >= 0) continue;
    rim[topology.edges(e, 0)] = rim[topology.edges(e, 1)] = true;
  }
  for (std::size_t v = 0; v < rim.size(); ++v) {
    if (!rim[v]) continue;
    double sum = 0, count = 0;
    for (const std::int32_t w : topology.vertexVertices[v]) {
      if (!rim[w]) sum += values[w], ++count;
    }
    values[v] = count > 0 ? sum / count : 0;
  }
}

}  // namespace

Eigen::VectorXd meanCurvature(const TriangleMesh& mesh, std::optional<double> fwhm) {
  const Eigen::VectorXd areas = geometry::vertexAreas(mesh);
  const Positions normals = geometry::vertexNormals(mesh);
  const Eigen::MatrixXd product = geometry::cotangentLaplacian(mesh) * mesh.positions;
  Eigen::VectorXd curvature = Eigen::VectorXd::Zero(mesh.vertexCount());
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    if (areas[v] <= 0) continue;
    // L is positive semi-definite: -L x / area = Laplacian of position = 2 H n.  Sliver faces can
    // make it any number: a mesh resolves no radius below the size of a vertex's surroundings.
    const double bound = 1 / std::sqrt(areas[v]);
    curvature[v] = std::clamp(-0.5 * product.row(v).dot(normals.row(v)) / areas[v], -bound, bound);
  }
  fillBoundary(mesh, curvature);
  const double width = fwhm.value_or(kCurvatureWidth * std::sqrt(areas.sum()));
  return width > 0 ? Eigen::VectorXd(smoothMaps(mesh, curvature, width)) : curvature;
}

Eigen::VectorXd sulcalDepth(const TriangleMesh& mesh) {
  const Eigen::VectorXd areas = geometry::vertexAreas(mesh);
  const HeatFlow flow(mesh, kInflationTime / kInflationSteps * areas.sum());
  TriangleMesh inflated = mesh;
  Positions normals = geometry::vertexNormals(mesh);
  Eigen::VectorXd travelled = Eigen::VectorXd::Zero(mesh.vertexCount());
  for (int step = 0; step < kInflationSteps; ++step) {
    Eigen::MatrixXd positions = inflated.positions;
    flow.advance(positions);
    const Positions moves = positions - inflated.positions;
    inflated.positions = positions;
    const Positions after = geometry::vertexNormals(inflated);
    const Positions along = (normals + after).rowwise().normalized();
    travelled += moves.cwiseProduct(along).rowwise().sum();
    normals = after;
  }
  return travelled.array() - areas.dot(travelled) / areas.sum();
}

TriangleMesh inflated(const TriangleMesh& mesh) {
  constexpr double kShown = 3;  // times the depth's inflation: sulci are open to the eye
  const double area = geometry::totalArea(mesh);
  const HeatFlow flow(mesh, kShown * kInflationTime / kInflationSteps * area);
  TriangleMesh result = mesh;
  const Eigen::RowVector3d centre = mesh.positions.colwise().mean();
  Eigen::MatrixXd positions = mesh.positions.rowwise() - centre;
  for (int step = 0; step < kInflationSteps; ++step) flow.advance(positions);
  result.positions = positions;
  result.positions *= std::sqrt(area / geometry::totalArea(result));
  result.positions.rowwise() += centre;
  return result;
}

}  // namespace explica::maps
