// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Explica/Correspondence/AnatomicalGrid.h"
#include "Explica/IO/SurfaceFile.h"
#include "Explica/IO/VolumeFile.h"

#include <string>
#include <vector>

namespace explica::app {

/// Functions in the tissue's own coordinates: which volumes to carry onto the anatomical grid, and
/// along which trajectories to list them.
struct GridFunctions {
  std::vector<std::string> volumes;
  std::vector<Eigen::Vector3d> along;
};

/// Values of every frame of the volumes at the grid's points by trilinear interpolation, NaN where
/// a volume is not known.
/// @throws InvalidInput  a volume that does not meet the grid at all
[[nodiscard]] std::vector<io::VertexMap> functionsOnGrid(
    Context& context, const GridFunctions& functions, const io::VolumeReadOptions& reading,
    const correspondence::AnatomicalGrid& grid);

/// Mean, deviation and count of each function at each depth, over whole trajectories.
[[nodiscard]] std::string depthTable(const std::vector<io::VertexMap>& functions,
                                     const correspondence::AnatomicalGrid& grid);

/// The functions along the trajectories nearest to points, from the inner to the outer boundary.
/// @throws InvalidInput  a point farther from the grid than the tissue is thick there
[[nodiscard]] std::string trajectoryTable(const std::vector<io::VertexMap>& functions,
                                          const correspondence::AnatomicalGrid& grid,
                                          const std::vector<Eigen::Vector3d>& along);

}  // namespace explica::app
