// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Grids as scanners give them, and volumes that are functions of the place.
#pragma once

#include "Explica/Core/Volume.h"

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <vector>

namespace explica::testing {

/// Anisotropic, along the axes, oblique, and oblique with a mirrored axis; all hold the ball of 20
/// mm about (3, -4, 5).
inline std::vector<Grid> scannerGrids() {
  std::vector<Grid> grids(3);
  grids[0].size = {60, 50, 30};
  grids[0].spacing = {0.9, 1.2, 2.1};
  grids[1].size = {46, 44, 40};
  grids[1].spacing = {1.4, 1.3, 1.7};
  grids[1].direction = (Eigen::AngleAxisd(0.4, Vector(1, -2, 3).normalized()) *
                        Eigen::AngleAxisd(1.2, Vector::UnitZ()))
                           .toRotationMatrix();
  grids[2] = grids[1];
  grids[2].direction.col(1) *= -1;
  for (Grid& grid : grids) {
    const Vector middle = 0.5 * Vector(grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1);
    grid.origin = Point(3, -4, 5) - grid.direction * grid.spacing.cwiseProduct(middle);
  }
  return grids;
}

/// n x n x n voxels of that many mm about the origin.
inline Grid cubeGrid(int n, double spacing) {
  Grid grid;
  grid.size = {n, n, n};
  grid.spacing = Vector::Constant(spacing);
  grid.origin = Point::Constant(-0.5 * (n - 1) * spacing);
  return grid;
}

/// f(place) at each voxel centre.
template <class Function>
Volume<float> volumeOf(const Grid& grid, const Function& f) {
  Volume<float> volume(grid);
  for (std::size_t v = 0; v < volume.size(); ++v) {
    const auto [i, j, k] = grid.subscripts(v);
    volume[v] = static_cast<float>(f(grid.toWorld(Vector(i, j, k))));
  }
  return volume;
}

/// A ball with twelve waves, white matter 3 in a ribbon 2, some sulci of it buried.
/// @param unit  mm to a voxel
inline Volume<Label> wavyBall(double unit) {
  constexpr int n = 62;
  Volume<Label> labels(cubeGrid(n, unit));
  for (std::size_t v = 0; v < labels.size(); ++v) {
    const auto at = labels.grid.subscripts(v);
    const Vector p = Vector(at[0], at[1], at[2]) - Vector::Constant(0.5 * (n - 1));
    const double r = p.norm(), flat = std::hypot(p.x(), p.y()) / r;
    const double wave = 4 * std::sin(12 * std::atan2(p.y(), p.x())) * flat * flat;
    labels[v] = r < 20 + wave ? 3 : r < 23 || r < 23 + wave ? 2 : 0;
  }
  return labels;
}

/// Trilinear at a point in RAS mm; 0 beyond the volume.
inline double valueAt(const Volume<float>& volume, const Point& p) {
  const Vector index = volume.grid.toIndex(p);
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    std::array<int, 3> corner{};
    double weight = 1;
    for (int a = 0; a < 3; ++a) {
      corner[a] = static_cast<int>(std::floor(index[a])) + (c >> a & 1);
      weight *= 1 - std::abs(index[a] - corner[a]);
    }
    if (weight > 0 && volume.grid.contains(corner[0], corner[1], corner[2])) {
      sum += weight * volume(corner[0], corner[1], corner[2]);
    }
  }
  return sum;
}

}  // namespace explica::testing
