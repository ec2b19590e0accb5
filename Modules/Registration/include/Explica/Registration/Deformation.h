// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Registration/HeadTransform.h"

namespace explica::registration {

/// How far the deformation may go, and how long it is sought.
struct DeformationOptions {
  double spacing = 2;       ///< of the finest grid, mm, for a human head
  double forceWidth = 2;    ///< standard deviation of each update's smoothing, voxels of its grid
  double fieldWidth = 0.6;  ///< of the whole field's after each update, voxels of its grid
  int radius = 3;           ///< of the windows in which images are compared, voxels
  int maxIterations = 50;   ///< on each of the grids
};

/// How image and brought template agree.
struct Agreement {
  double correlation = 0;    ///< mean squared correlation in windows of the region
  double leastJacobian = 0;  ///< of the displacement; above 0 nothing is folded
};

/// A deformation that brings the template's details onto the image's, after an affine map.
struct DeformationResult {
  HeadTransform transform;
  Agreement agreement;
};

/// Greedy diffeomorphic registration: small smooth updates, each composed with what there is
/// [Christensen1996], climb the squared correlation of image and template in windows [Avants2008],
/// from grids of four times the spacing to the finest.  Windows make it indifferent to bias fields
/// and to the contrast of scanners; composition of small steps keeps it free of folds.
///
/// @param region           on the template's grid, 0 to 1: where it counts
/// @param imageToTemplate  affine, RAS mm
/// The result does not depend on the number of threads.
[[nodiscard]] DeformationResult registerDeformation(const Volume<float>& image,
                                                    const Volume<float>& inTemplate,
                                                    const Volume<float>& region,
                                                    const Eigen::Affine3d& imageToTemplate,
                                                    const DeformationOptions& options = {},
                                                    const Monitor& monitor = {});

/// How a transform that is known already brings the template onto the image, compared as
/// `registerDeformation` compares its own.
[[nodiscard]] Agreement agreementOf(const Volume<float>& image, const Volume<float>& inTemplate,
                                    const Volume<float>& region, const HeadTransform& transform,
                                    const DeformationOptions& options = {});

}  // namespace explica::registration
