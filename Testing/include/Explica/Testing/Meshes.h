// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <cmath>

namespace explica::geometry {

/// Torus about the z axis: `major` to the tube's centre, `minor` the tube; genus 1.
inline TriangleMesh makeTorus(int majorSegments, int minorSegments, double major, double minor) {
  TriangleMesh mesh;
  mesh.positions.resize(static_cast<Eigen::Index>(majorSegments) * minorSegments, 3);
  mesh.faces.resize(2 * mesh.positions.rows(), 3);
  const auto index = [&](int i, int j) {
    return (i % majorSegments) * minorSegments + j % minorSegments;
  };
  for (int i = 0; i < majorSegments; ++i) {
    for (int j = 0; j < minorSegments; ++j) {
      const double u = 2 * kPi * i / majorSegments, v = 2 * kPi * j / minorSegments;
      const double ring = major + minor * std::cos(v);
      mesh.positions.row(index(i, j)) << ring * std::cos(u), ring * std::sin(u),
          minor * std::sin(v);
      const int f = 2 * index(i, j);
      mesh.faces.row(f) << index(i, j), index(i + 1, j), index(i + 1, j + 1);
      mesh.faces.row(f + 1) << index(i, j), index(i + 1, j + 1), index(i, j + 1);
    }
  }
  return mesh;
}

/// Flat rectangle [0, width] x [0, height] in z = 0, normal +z, cells split in two.
inline TriangleMesh makeRectangle(int columns, int rows, double width, double height) {
  TriangleMesh mesh;
  mesh.positions.resize(static_cast<Eigen::Index>(columns + 1) * (rows + 1), 3);
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      mesh.positions.row(j * (columns + 1) + i) << width * i / columns, height * j / rows, 0;
    }
  }
  mesh.faces.resize(static_cast<Eigen::Index>(2) * columns * rows, 3);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const int a = j * (columns + 1) + i, b = a + 1, c = a + columns + 1, d = c + 1;
      const int f = 2 * (j * columns + i);
      mesh.faces.row(f) << a, b, d;
      mesh.faces.row(f + 1) << a, d, c;
    }
  }
  return mesh;
}

}  // namespace explica::geometry
