// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Surface/LevelSet.h"
#include "RibbonPaths.h"

#include <Eigen/Core>

#include <vector>

namespace explica::surface {

/// The outer border of a tissue, moved along trajectories through it.
///
/// Each trajectory says of the places along it how far its new end is; a voxel near some of them
/// has the mean of what they say of it, each by the plane across the trajectory.  Where none is
/// near, and along trajectories to the middle of a sulcus whose end stays, the old border holds.
/// @param distance  to the old border, as distanceLevelOf()
/// @param moved     per trajectory: how far its end goes, outward, mm
/// @return the distance to the new border, as distanceLevelOf(), within two voxels of it
[[nodiscard]] LevelSet levelOfEnds(const LevelSet& distance, const std::vector<Trajectory>& paths,
                                   const Eigen::VectorXd& moved);

}  // namespace explica::surface
