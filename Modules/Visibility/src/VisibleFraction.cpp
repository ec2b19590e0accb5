// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Visibility/VisibleFraction.h"

#include "Rays.h"

#include "Explica/Core/Errors.h"
#include "Explica/Geometry/MeshMeasures.h"

#include <string>

namespace explica::visibility {
namespace {

double meanOver(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces,
                const Eigen::VectorXd& values) {
  const Eigen::VectorXd areas = geometry::faceAreas(mesh);
  double sum = 0;
  double area = 0;
  for (const std::int32_t f : faces) {
    sum += values[f] * areas[f];
    area += areas[f];
  }
  return area > 0 ? sum / area : 0;
}

}  // namespace

double VisibleFraction::of(const TriangleMesh& mesh, const std::vector<std::int32_t>& faces) const {
  return meanOver(mesh, faces, face);
}

double VisibleFraction::realOf(const TriangleMesh& mesh,
                               const std::vector<std::int32_t>& faces) const {
  return meanOver(mesh, faces, arriving);
}

void VisibleFraction::addUp(const TriangleMesh& mesh) {
  const Eigen::VectorXd areas = geometry::faceAreas(mesh);
  total = areas.sum() > 0 ? face.dot(areas) / areas.sum() : 0;
  vertex.setZero(mesh.vertexCount());
  Eigen::VectorXd around = Eigen::VectorXd::Zero(mesh.vertexCount());
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    for (int k = 0; k < 3; ++k) {
      vertex[mesh.faces(f, k)] += face[f] * areas[f];
      around[mesh.faces(f, k)] += areas[f];
    }
  }
  for (Eigen::Index v = 0; v < around.size(); ++v) {
    vertex[v] = around[v] > 0 ? vertex[v] / around[v] : 0;
  }
}

VisibleFraction visibleFraction(const TriangleMesh& mesh, const Viewpoints& viewpoints,
                                const VisibleFractionOptions& options) {
  requireInputs(mesh, viewpoints, "visible fraction");
  if (options.subdivision < 1 || options.subdivision > 64) {
    throw InvalidInput("visible fraction: subdivision is " + std::to_string(options.subdivision) +
                       "; it must lie between 1 and 64");
  }
  const Rays rays(mesh, viewpoints, options.subdivision, frameOf(mesh.positions));
  VisibleFraction result;
  result.face.setZero(mesh.faceCount());
  result.arriving.setZero(mesh.faceCount());
  const auto count = static_cast<std::size_t>(mesh.faceCount());
  rays.look(count, [&](std::size_t f, const Rays::Share& share) {
    result.face[static_cast<Eigen::Index>(f)] = share.seen;
    result.arriving[static_cast<Eigen::Index>(f)] = share.arriving;
  });
  result.addUp(mesh);
  return result;
}

}  // namespace explica::visibility
