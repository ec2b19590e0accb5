// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "BorderChooser.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Core/Volume.h"
#include "Explica/Surface/CorticalSurface.h"
#include "Explica/Surface/LevelSet.h"
#include "RibbonPaths.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace explica::surface {

/// How one border is looked for; lengths in voxels of the labels.
struct EdgeOptions {
  double level = 0.5;   ///< brightness of the border, from 0, outside, to 1, inside of it
  double spread = 1.7;  ///< deviation of the window in which brightness of tissue is averaged
  ChoiceCosts costs = {0.5, 0.1};  ///< beside squared shares of the contrast
};

struct ImageBorderOptions {
  EdgeOptions white = {};
  EdgeOptions outer = {0.45, 4.1, {0.2, 0.3}};
  EdgeOptions besideFluid = {0.5, 2.4, {0.2, 0.3}};  ///< outer, if `fluid` is known: its level then
                                                     ///< comes of how dark the sulcus is
  double reach = 1;     ///< farthest that a border may lie from that of the labels
  double flat = 0.3;    ///< share of the usual contrast below which an edge is missing
  int rounds = 15;      ///< of weighing a vertex's edge against its neighbours
  double fluid = 0;     ///< brightness of pure fluid, of that of white matter; 0: not known
  bool search = false;  ///< the white border is first searched over millimetres: no labels, but one
                        ///< brightness for a neighbourhood, have put it where it is
};

/// Where the image puts the borders, beside where the labels do.
struct ImageBorders {
  Eigen::VectorXd white;    ///< per vertex, mm outward along the trajectory
  Eigen::VectorXd outer;    ///< per vertex, mm outward along the trajectory
  Eigen::MatrixXd doubt;    ///< V x 2: standard deviation of their places, mm
  Eigen::MatrixXd missing;  ///< V x 2: 1 where the image shows no such edge, or off the image: the
                            ///< labels' border stays; else 0
};

/// Places on the trajectories where the image crosses from one tissue to the next.
///
/// The edge of two tissues seen through a point spread is steepest half way between their
/// brightness; where it is steepest voxel by voxel, noise decides.  So brightness of white matter,
/// grey matter and what is outside is taken along each trajectory, carried on straight beyond both
/// ends, and averaged over neighbours; of white matter only what lies deep, since within a thin
/// blade it is seen mixed with the cortex of the other side.  Each vertex then looks for that level
/// near the labels' border, and weighs how far it is missed against the distance from the labels'
/// border and from its neighbours' choices.  Only a change of the usual sense counts, as most
/// vertices have it between white and grey matter (in a T1 brightness falls outward at both
/// borders): a vessel or meninges, where it rises, are no edge.  A trajectory that ends between two
/// banks of a sulcus is carried on by half a voxel only, as well as their middle is known: the
/// other bank's edge is not its own.
///
/// A second image, such as a T2 or FLAIR, is looked at beside the first at the outer border alone:
/// the misses of both, each in contrasts of its own tissues, are averaged by the inverse of their
/// variances by noise, as of two measurements of one place.
/// @param inner  white matter's level as distanceLevelOf()
[[nodiscard]] ImageBorders findBorders(const std::vector<Trajectory>& paths,
                                       const TriangleMesh& white, const LevelSet& inner,
                                       const BorderImages& images, double voxel,
                                       const ImageBorderOptions& options = {});

}  // namespace explica::surface
