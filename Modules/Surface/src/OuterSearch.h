// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/MeshTopology.h"
#include "MaskedImage.h"
#include "RibbonPaths.h"

#include <Eigen/Core>

#include <vector>

namespace explica::surface {

/// How far the outer border is searched inward; lengths in voxels.
struct OuterSearchOptions {
  double farthest = 2;    ///< what lies no deeper than that is left to the border's choice by level
  double beyond = 2;      ///< how far outside of the border the darkest is looked for
  double greySpread = 4;  ///< deviation of the neighbourhood whose grey matter is taken together
  double flat = 0.3;      ///< share of the usual contrast below which there is no edge
};

/// Ways to where cortex ends, inward from a start that may lie in other tissue: dura, the wall of a
/// sinus and muscle are as bright as grey matter's class, so that brightness voxel by voxel puts
/// the border beyond them.
///
/// Cortex has the brightness of the cortex around.  So grey matter is looked at no deeper than a
/// cortex is usually thick, and averaged over a neighbourhood; a trajectory that is darker than
/// half way from there to the first darkest that it reaches has left the cortex there, if that is
/// more than two voxels before its end.  Where a mask ends the image before it has become darkest,
/// nothing is known to lie beyond, and nothing is searched.  Medians of a vertex and two rings tell
/// noise from that.
/// @param paths  from the white border
/// @param edge   mean length of the edges, mm
/// @param fluidContrast  of grey matter and pure fluid; 0: not known, and the usual contrast of
/// what
///               is seen takes its place, which is small in a brain that was cut out tightly
/// @param sign   1 if white matter is brighter than grey matter, else -1
/// @return per vertex, mm outward along the trajectory from its end: 0 or less
[[nodiscard]] Eigen::VectorXd searchOuter(const std::vector<Trajectory>& paths,
                                          const geometry::MeshTopology& topology, double edge,
                                          const MaskedImage& image, double voxel, double sign,
                                          double fluidContrast,
                                          const OuterSearchOptions& options = {});

}  // namespace explica::surface
