// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
// Grids as scanners give them, and volumes that are functions of the place.
#pragma once

#include "Explica/Core/Volume.h"

#include <Eigen/Geometry>

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

}  // namespace explica::testing
