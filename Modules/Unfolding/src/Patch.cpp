// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Patch.h"

#include <Eigen/Geometry>

namespace explica::unfolding {

FaceShape shapeOf(const PatchFace& face, const Positions& x) {
  const Point a = x.row(face.vertices[0]).transpose(), b = x.row(face.vertices[1]).transpose(),
              c = x.row(face.vertices[2]).transpose();
  const Vector twice = (b - a).cross(c - a);
  const double length = twice.norm();
  FaceShape shape;
  shape.normal = twice / length;
  shape.area = 0.5 * length;
  shape.hat = {shape.normal.cross(c - b) / length, shape.normal.cross(a - c) / length,
               shape.normal.cross(b - a) / length};
  return shape;
}

Point centroidOf(const PatchFace& face, const Positions& x) {
  return (x.row(face.vertices[0]) + x.row(face.vertices[1]) + x.row(face.vertices[2])).transpose() /
         3;
}

void listAround(Patch& patch, const std::vector<std::int32_t>& unknown) {
  patch.facesAround =
      Around(patch.faces.size(), unknown, [&](std::size_t f) { return patch.faces[f].vertices; });
  patch.springsAround = Around(patch.springs.size(), unknown,
                               [&](std::size_t s) { return patch.springs[s].vertices; });
}

}  // namespace explica::unfolding
