// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Testing/Meshes.h"

#include <cmath>
#include <vector>

namespace explica::unfolding {

/// A flat sheet bent isometrically, up to the grid, into folds that overhang: its profile is the
/// sine-generated curve whose direction swings by +-`swingRad`.  Seen from +z.
inline TriangleMesh makeMeander(int columns, int rows, double swingRad = 1.9, int waves = 2) {
  TriangleMesh mesh = geometry::makeRectangle(columns, rows, columns, rows);
  Eigen::VectorXd x(columns + 1), z(columns + 1);
  x[0] = z[0] = 0;
  for (int i = 0; i < columns; ++i) {
    const double angle = swingRad * std::sin(2 * kPi * waves * (i + 0.5) / columns);
    x[i + 1] = x[i] + std::cos(angle);
    z[i + 1] = z[i] + std::sin(angle);
  }
  for (Eigen::Index v = 0; v < mesh.vertexCount(); ++v) {
    const int i = static_cast<int>(std::lround(mesh.positions(v, 0)));
    mesh.positions(v, 2) = z[i] + 0.2 * std::sin(0.3 * mesh.positions(v, 1));
    mesh.positions(v, 0) = x[i];
  }
  return mesh;
}

/// Marks all vertices at least `border` grid steps from the sheet's rim.
inline std::vector<bool> interiorOf(int columns, int rows, int border) {
  const TriangleMesh flat = geometry::makeRectangle(columns, rows, columns, rows);
  std::vector<bool> inside(static_cast<std::size_t>(flat.vertexCount()));
  for (Eigen::Index v = 0; v < flat.vertexCount(); ++v) {
    const double i = flat.positions(v, 0), j = flat.positions(v, 1);
    inside[v] = i >= border && j >= border && i <= columns - border && j <= rows - border;
  }
  return inside;
}

}  // namespace explica::unfolding
