// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Harmonic/Phantoms.h"

namespace explica::phantom {

/// A spherical shell of tissue about the grid's centre.
struct ShellOptions {
  int size = 64;                                     ///< voxels along the first axis, >= 8
  double spacing = 1.0;                              ///< mm, along the first axis
  double innerRadius = 0.5;                          ///< of the half width of the grid
  double outerRadius = 0.8;                          ///< of the half width of the grid
  Eigen::Vector3d aspect = Eigen::Vector3d::Ones();  ///< spacing along each axis over `spacing`
};

template <class Visitor>
void describe(ShellOptions& options, Visitor&& visit) {
  visit(Field{"size", "", "voxels along the first axis", 8, 1024}, options.size);
  visit(Field{"spacing", "mm", "voxel size along the first axis"}, options.spacing);
  visit(Field{"inner-radius", "", "inner radius over half the grid's width"}, options.innerRadius);
  visit(Field{"outer-radius", "", "outer radius over half the grid's width"}, options.outerRadius);
  visit(Field{"aspect", "", "voxel size along each axis over --spacing"}, options.aspect);
}

/// Labels 1 inside, 2 tissue, 0 outside; levels are distances from the spheres.
struct Shell : harmonic::Phantom {
  double innerRadius = 0;                                                       ///< a, mm
  double outerRadius = 0;                                                       ///< b, mm
  [[nodiscard]] double thickness() const { return outerRadius - innerRadius; }  ///< everywhere
};

/// Concentric spheres of radii a < b: trajectories are radii, thickness is b - a everywhere, and
/// the harmonic function between them is linear in 1/r.
/// @throws InvalidInput  an option out of range, or a shell that does not fit its grid
[[nodiscard]] Shell makeShell(const ShellOptions& options = {});

}  // namespace explica::phantom
