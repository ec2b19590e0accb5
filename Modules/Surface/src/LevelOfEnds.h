// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Surface/LevelSet.h"
#include "RibbonPaths.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace explica::surface {

/// Where trajectories start, and where they end.
enum class PathBorder : std::uint8_t { Inner, Outer };

/// A border of a tissue, moved along the trajectories through it.
///
/// Each trajectory says of the places along it how far its new end is; a voxel near some of them
/// has the mean of what they say of it, each by the plane across the trajectory.  Where none is
/// near, and along trajectories to the middle of a sulcus, the old border holds.
/// @param distance  to the old border, as distanceLevelOf(): positive on the side of white matter
/// @param border    whose level it is
/// @param moved     per trajectory: how far its border goes, outward, mm
/// @return the distance to the new border, as distanceLevelOf(), within two voxels of it
[[nodiscard]] LevelSet levelOfEnds(const LevelSet& distance, const std::vector<Trajectory>& paths,
                                   PathBorder border, const Eigen::VectorXd& moved);

}  // namespace explica::surface
