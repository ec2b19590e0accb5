// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "CrossingLength.h"

#include "Explica/Geometry/FaceCrossing.h"

#include <Eigen/Geometry>

#include <cmath>

namespace explica::collision {

/// The piercing point p of an edge (direction d) and a face (unit normal n) moves with the velocity
/// u of the edge's point and w of the face's point there as  p' = u - d (n.(u - w)) / (n.d).
CrossingLength crossingLength(const TriangleMesh& mesh, std::span<const geometry::FacePair> pairs) {
  CrossingLength length{0, Positions::Zero(mesh.vertexCount(), 3)};
  const auto point = [&](std::int32_t v) { return Point(mesh.positions.row(v).transpose()); };
  for (const geometry::FacePair& pair : pairs) {
    const auto segment = geometry::crossingSegment(mesh, pair);
    if (!segment) continue;
    const Vector whole = (*segment)[1].point - (*segment)[0].point;
    length.value += whole.norm();
    for (int side = 0; side < 2; ++side) {
      const geometry::CrossingEnd& end = (*segment)[side];
      const Vector pull = (side == 0 ? -1 : 1) * whole.normalized();  // d length / d p
      if (end.edge[0] == end.edge[1]) {
        length.gradient.row(end.edge[0]) += pull.transpose();
        continue;
      }
      const Vector d = (point(end.edge[1]) - point(end.edge[0])).normalized();
      const Vector n = (point(end.face[1]) - point(end.face[0]))
                           .cross(point(end.face[2]) - point(end.face[0]))
                           .normalized();
      constexpr double kGrazing = 0.1;  // sine below which the rate is bounded
      double sine = n.dot(d);
      if (std::abs(sine) < kGrazing) sine = sine < 0 ? -kGrazing : kGrazing;
      const Vector throughFace = (pull.dot(d) / sine) * n;
      for (int k = 0; k < 2; ++k) {
        length.gradient.row(end.edge[k]) += end.edgeWeights[k] * (pull - throughFace).transpose();
      }
      for (int k = 0; k < 3; ++k) {
        length.gradient.row(end.face[k]) += end.faceWeights[k] * throughFace.transpose();
      }
    }
  }
  return length;
}

}  // namespace explica::collision
