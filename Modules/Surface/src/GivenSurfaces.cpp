// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Surface/GivenSurfaces.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"
#include "Explica/Geometry/FaceTree.h"
#include "Explica/Geometry/MeshMeasures.h"
#include "Explica/Maps/Folding.h"

#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace explica::surface {
namespace {

void requireSameFaces(const TriangleMesh& white, const TriangleMesh& other, const char* name) {
  if (other.vertexCount() == white.vertexCount() && other.faces.rows() == white.faces.rows() &&
      other.faces == white.faces) {
    return;
  }
  throw InvalidInput(
      std::string("surfaces: the white surface (") + std::to_string(white.vertexCount()) +
      " vertices, " + std::to_string(white.faceCount()) + " faces) and the " + name + " one (" +
      std::to_string(other.vertexCount()) + ", " + std::to_string(other.faceCount()) +
      ") must have the same faces, vertex for vertex");
}

}  // namespace

Eigen::VectorXd distanceThickness(const TriangleMesh& white, const TriangleMesh& pial) {
  std::array<std::optional<geometry::FaceTree>, 2> trees;
  parallelFor(2, 1, [&](std::size_t n) { trees[n].emplace(n == 0 ? white : pial); });
  // What lies beyond a vertex is near its own face of the other surface.
  const std::vector<std::int32_t> faceAt = geometry::faceOfEachVertex(white);
  Eigen::VectorXd thickness(white.vertexCount());
  parallelFor(faceAt.size(), 1024, [&](std::size_t v) {
    const Point inner = white.positions.row(v).transpose();
    const Point outer = pial.positions.row(v).transpose();
    const double outward = trees[1]->closestPoint(inner, faceAt[v]).squaredDistance;
    const double inward = trees[0]->closestPoint(outer, faceAt[v]).squaredDistance;
    thickness[v] = inner == outer ? 0.0 : 0.5 * (std::sqrt(outward) + std::sqrt(inward));
  });
  return thickness;
}

CorticalSurfaces adoptSurfaces(TriangleMesh white, TriangleMesh pial,
                               std::optional<TriangleMesh> mid) {
  requireSameFaces(white, pial, "pial");
  if (mid) requireSameFaces(white, *mid, "middle");
  if (geometry::turnOutward(white)) {
    pial.faces = white.faces;
    if (mid) mid->faces = white.faces;
  }
  CorticalSurfaces surfaces;
  surfaces.thickness = distanceThickness(white, pial);
  surfaces.nearestThickness = surfaces.thickness;
  surfaces.noRibbon = (surfaces.thickness.array() == 0).count();
  surfaces.curvature = maps::meanCurvature(white);
  surfaces.sulcalDepth = maps::sulcalDepth(white);
  surfaces.mid =
      mid ? std::move(*mid) : TriangleMesh{0.5 * (white.positions + pial.positions), white.faces};
  surfaces.columns = {white.positions, pial.positions, geometry::vertexAreas(surfaces.mid),
                      surfaces.thickness};
  surfaces.white.mesh = std::move(white);
  surfaces.pial = std::move(pial);
  return surfaces;
}

}  // namespace explica::surface
