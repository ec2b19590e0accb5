// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// A rasteriser with a depth buffer: the second opinion on what a viewpoint sees.  It shares nothing
// with the ray caster that it judges: projection instead of rays, pixels instead of samples, double
// precision instead of single.
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <vector>

namespace explica::testing {

/// Pixels of each face in the picture from one point.
struct FacePixels {
  std::vector<double> covered;  ///< by the face's projection
  std::vector<double> seen;     ///< where it is the nearest face and looks at the viewpoint
};

/// Projects the mesh onto `side` x `side` pixels that just hold it.  All of it must lie before
/// `eye`.
inline FacePixels renderFaces(const TriangleMesh& mesh, const Point& eye, int side) {
  const Point middle =
      0.5 * (mesh.positions.colwise().minCoeff() + mesh.positions.colwise().maxCoeff()).transpose();
  const Vector forward = (middle - eye).normalized();
  const Vector right = forward.unitOrthogonal(), up = right.cross(forward);
  Positions screen(mesh.vertexCount(), 3);  // x / z, y / z, 1 / z: 1 / z is linear on the screen
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const Vector p = mesh.positions.row(v).transpose() - eye;
    const double z = p.dot(forward);
    if (!(z > 0)) throw std::invalid_argument("renderFaces: a vertex behind the viewpoint");
    screen.row(v) << p.dot(right) / z, p.dot(up) / z, 1 / z;
  }
  const Eigen::RowVector3d low = screen.colwise().minCoeff(), high = screen.colwise().maxCoeff();
  const double pixel = 1.000001 * std::max(high[0] - low[0], high[1] - low[1]) / side;
  for (int k = 0; k < 2; ++k) screen.col(k) = (screen.col(k).array() - low[k]) / pixel;

  const auto count = static_cast<std::size_t>(mesh.faceCount());
  FacePixels result{std::vector<double>(count, 0), std::vector<double>(count, 0)};
  std::vector<double> nearest(static_cast<std::size_t>(side) * side, 0);  // largest 1 / z
  std::vector<std::int32_t> owner(nearest.size(), -1);
  std::vector<bool> looksHere(count);
  for (std::size_t f = 0; f < count; ++f) {
    const auto face = static_cast<Eigen::Index>(f);
    const Vector normal = (mesh.corner(face, 1) - mesh.corner(face, 0))
                              .cross(mesh.corner(face, 2) - mesh.corner(face, 0));
    looksHere[f] = normal.dot(eye - mesh.corner(face, 0)) > 0;
    const Eigen::RowVector3d a = screen.row(mesh.faces(face, 0)),
                             b = screen.row(mesh.faces(face, 1)),
                             c = screen.row(mesh.faces(face, 2));
    const double area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    if (area == 0) continue;
    const auto range = [&](int k) {
      const double least = std::min({a[k], b[k], c[k]}), most = std::max({a[k], b[k], c[k]});
      return std::pair{std::max(0, static_cast<int>(std::floor(least - 0.5))),
                       std::min(side - 1, static_cast<int>(std::ceil(most - 0.5)))};
    };
    const auto [x0, x1] = range(0);
    const auto [y0, y1] = range(1);
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        const double px = x + 0.5, py = y + 0.5;
        const double u = ((b[0] - px) * (c[1] - py) - (b[1] - py) * (c[0] - px)) / area;
        const double v = ((c[0] - px) * (a[1] - py) - (c[1] - py) * (a[0] - px)) / area;
        const double w = 1 - u - v;
        if (u < 0 || v < 0 || w < 0) continue;
        result.covered[f] += 1;
        const double inverseDepth = u * a[2] + v * b[2] + w * c[2];
        const std::size_t at = static_cast<std::size_t>(y) * side + x;
        if (inverseDepth <= nearest[at]) continue;
        nearest[at] = inverseDepth;
        owner[at] = static_cast<std::int32_t>(f);
      }
    }
  }
  for (const std::int32_t f : owner) {
    if (f >= 0 && looksHere[f]) result.seen[f] += 1;
  }
  return result;
}

/// Share of the area of the listed faces that the picture shows; faces without a pixel, edge-on or
/// tiny, do not count.
inline double seenShare(const TriangleMesh& mesh, std::span<const std::int32_t> faces,
                        const FacePixels& pixels) {
  double seen = 0, all = 0;
  for (const std::int32_t f : faces) {
    if (pixels.covered[f] == 0) continue;
    const double area =
        (mesh.corner(f, 1) - mesh.corner(f, 0)).cross(mesh.corner(f, 2) - mesh.corner(f, 0)).norm();
    all += area;
    seen += area * pixels.seen[f] / pixels.covered[f];
  }
  return seen / all;
}

}  // namespace explica::testing
