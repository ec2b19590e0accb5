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

Eigen::Matrix3d faceBlock(const FaceShape& shape, const FaceStiffness& stiffness, int i, int j) {
  const Eigen::Matrix3d normal = stiffness.across * shape.normal * shape.normal.transpose();
  return stiffness.inPlane * shape.hat[i] * shape.hat[j].transpose() +
         shape.hat[i].dot(shape.hat[j]) * normal;
}

void addForces(std::span<const PatchFace> faces, std::span<const CornerForces> forces,
               Positions& gradient) {
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) gradient.row(faces[f].vertices[k]) += forces[f][k].transpose();
  }
}

void addFaceBlocks(const Patch& patch, std::span<const FaceShape> shapes, std::size_t firstFace,
                   std::span<const FaceStiffness> stiffness,
                   const std::vector<std::int32_t>& unknown, BlockSystem& system) {
  const auto verticesOf = [&](std::int32_t f) { return patch.faces[f].vertices; };
  addBlocks(patch.facesAround, firstFace, stiffness.size(), verticesOf, unknown, system,
            [&](std::int32_t f, int i, int j) {
              return faceBlock(shapes[f], stiffness[f - firstFace], i, j);
            });
}

}  // namespace explica::unfolding
