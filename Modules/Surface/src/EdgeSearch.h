// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/MeshTopology.h"
#include "MaskedImage.h"
#include "RibbonPaths.h"

#include <Eigen/Core>

#include <vector>

namespace explica::surface {

/// How far and how a border is searched; lengths in voxels.
struct EdgeSearchOptions {
  double inward = 3.5;   ///< as far as one level for a whole neighbourhood errs in cortex that
                         ///< myelin makes nearly as bright as white matter
  double outward = 1.5;  ///< and never beyond half of the ribbon: the next edge is the outer one's
  double spread = 1.3;   ///< deviation of the window in which profiles are averaged
  int passes = 6;        ///< each may move the border by a voxel
  double likely = 1.5;   ///< of two edges alike the nearer one is meant: deviation of a Gaussian
  double centring = 0.05;  ///< see ChoiceCosts; the start says little
  double smoothness = 0.3;
  int rounds = 15;
};

/// Ways to where white matter ends, from a start that may be off by millimetres: one brightness for
/// all borders of a neighbourhood puts them into the cortex where myelin makes it bright, and into
/// white matter where its blades are thin.
///
/// The edge of white matter is where the profile along a trajectory falls most steeply beside what
/// is further in and out: a local maximum of the slope, so that the steeper fall to fluid beyond a
/// bright cortex is not taken for it.  Single profiles show noise; so each vertex's profile is the
/// mean of its neighbours', aligned at where the border is held to be, and again once it has moved.
/// What is darker than the usual middle of the ribbon is no border of white matter.  Each vertex
/// goes to where that edge lies on the average of its neighbours', and cuts its own profile near
/// there at the edge's brightness, averaged.  Going by brightness alone, it would never cross a
/// cortex that is nearly white and equally so all through.  Where a mask has cut the image off at
/// the cortex, its last voxels may be part fluid, and a fall to them is no border of white matter.
/// @param edge  mean length of the edges, mm
/// @return per vertex, mm outward along the trajectory
[[nodiscard]] Eigen::VectorXd searchWhite(const std::vector<Trajectory>& paths,
                                          const geometry::MeshTopology& topology, double edge,
                                          const MaskedImage& image, double voxel,
                                          const EdgeSearchOptions& options = {});

}  // namespace explica::surface
