// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Phantom/Shell.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Parallel.h"

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
  shell.thickness = shell.outerRadius - shell.innerRadius;
  shell.labels = Volume<Label>(grid);
  shell.level = shell.outerLevel = shell.harmonic = Volume<float>(grid);
  shell.innerDistance = shell.outerDistance = shell.thicknessMap = Volume<float>(grid, 0);
  shell.innerPoint = shell.outerPoint = Volume<Eigen::Vector3f>(grid, Eigen::Vector3f::Zero());
  const double a = shell.innerRadius, b = shell.outerRadius;
  constexpr std::size_t kGrain = 16384;  // elements a task
  parallelFor(grid.voxelCount(), kGrain, [&](std::size_t v) {
    const auto [i, j, k] = grid.subscripts(v);
    const Point x = grid.toWorld({double(i), double(j), double(k)});
    const double r = x.norm();
    shell.labels[v] = r < a ? Shell::kInner : r < b ? Shell::kTissue : Shell::kOuter;
    shell.level[v] = static_cast<float>(r - a);
    shell.outerLevel[v] = static_cast<float>(r - b);
    shell.harmonic[v] = r <= a   ? 0.f
                        : r >= b ? 1.f
                                 : static_cast<float>((1 / a - 1 / r) / (1 / a - 1 / b));
    if (shell.labels[v] != Shell::kTissue) return;
    shell.innerDistance[v] = static_cast<float>(r - a);
    shell.outerDistance[v] = static_cast<float>(b - r);
    shell.thicknessMap[v] = static_cast<float>(b - a);
    shell.innerPoint[v] = (a / r * x).cast<float>();
    shell.outerPoint[v] = (b / r * x).cast<float>();
  });
  return shell;
}

}  // namespace explica::phantom
