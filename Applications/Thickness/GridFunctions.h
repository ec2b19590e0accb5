// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Explica/Correspondence/AnatomicalGrid.h"
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

/// Writes the anatomical grid with the functions' values at its points; where there are functions,
/// their mean, deviation and count at each depth, and the trajectories that were asked for.
/// @throws InvalidInput  a volume that does not meet the grid at all, a point farther from the grid
///                       than the tissue is thick there
void writeGrid(Context& context, const GridFunctions& functions,
               const io::VolumeReadOptions& reading, const correspondence::AnatomicalGrid& grid);

}  // namespace explica::app
