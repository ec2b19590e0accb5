// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "FoldingPyramid.h"

namespace explica::sphere {

/// Rotations of the moving maps after which they agree well with the target's, best first: those of
/// least weighed mean of squared differences among rotations spread evenly over all.  Ends with the
/// identity: spheres made of heads in the same coordinate system differ little from it.
[[nodiscard]] std::vector<Eigen::Matrix3d> searchRotations(const std::vector<FoldingLevel>& moving,
                                                           const std::vector<FoldingLevel>& target,
                                                           const Monitor& monitor);

}  // namespace explica::sphere
