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

CornerBlocks faceBlocks(const FaceShape& shape, double inPlane, double across) {
  const Eigen::Matrix3d normal = across * shape.normal * shape.normal.transpose();
  CornerBlocks blocks;
  int n = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) {
      blocks[n++] = inPlane * shape.hat[i] * shape.hat[j].transpose() +
                    shape.hat[i].dot(shape.hat[j]) * normal;
    }
  }
  return blocks;
}

void addForces(std::span<const PatchFace> faces, std::span<const CornerForces> forces,
               Positions& gradient) {
  for (std::size_t f = 0; f < faces.size(); ++f) {
    for (int k = 0; k < 3; ++k) gradient.row(faces[f].vertices[k]) += forces[f][k].transpose();
  }
}

void addBlocks(std::span<const PatchFace> faces, std::span<const CornerBlocks> blocks,
               const std::vector<std::int32_t>& unknown, BlockSystem& system) {
  for (std::size_t f = 0; f < faces.size(); ++f) {
    int n = 0;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j, ++n) {
        const std::int32_t row = unknown[faces[f].vertices[i]];
        const std::int32_t column = unknown[faces[f].vertices[j]];
        if (row >= 0 && column >= 0) system.add(row, column, blocks[f][n]);
      }
    }
  }
}

}  // namespace explica::unfolding
