// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Phantom/Shell.h"

#include "Explica/Core/Errors.h"

#include <cmath>
#include <string>

namespace explica::phantom {

Shell makeShell(const ShellOptions& options) {
  if (options.size < 8 || options.size > 1024) {
    throw InvalidInput("size: " + std::to_string(options.size) + " voxels; 8 to 1024 are possible");
  }
  if (!(options.spacing > 0) || !(options.aspect.minCoeff() > 0) || !options.aspect.allFinite()) {
    throw InvalidInput("spacing and aspect: every voxel size must be positive");
  }
  if (!(0 < options.innerRadius && options.innerRadius < options.outerRadius &&
        options.outerRadius < 1)) {
    throw InvalidInput("inner-radius and outer-radius: 0 < inner < outer < 1 is needed, found " +
                       std::to_string(options.innerRadius) + " and " +
                       std::to_string(options.outerRadius));
  }

  const double halfWidth = 0.5 * options.size * options.spacing;
  Grid grid;
  grid.spacing = options.spacing * options.aspect;
  for (int axis = 0; axis < 3; ++axis) {
    grid.size[axis] = static_cast<int>(std::ceil(2 * halfWidth / grid.spacing[axis] - 1e-9));
    grid.origin[axis] = -0.5 * (grid.size[axis] - 1) * grid.spacing[axis];
  }

  Shell shell;
  shell.innerRadius = options.innerRadius * halfWidth;
  shell.outerRadius = options.outerRadius * halfWidth;
  shell.exact = harmonic::exactShell(shell.innerRadius, shell.outerRadius);
  shell.innerLevel = harmonic::sampled(grid, shell.exact.innerLevel);
  shell.outerLevel = harmonic::sampled(grid, shell.exact.outerLevel);
  shell.labelNames = {{"outside", 0}, {"inner", 1}, {"tissue", 2}};
  shell.labels = Volume<Label>(grid);
  for (std::size_t v = 0; v < grid.voxelCount(); ++v) {
    shell.labels[v] = shell.innerLevel[v] < 0 ? 1 : shell.outerLevel[v] < 0 ? 2 : 0;
  }
  return shell;
}

}  // namespace explica::phantom
