// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "FoldingPyramid.h"

namespace explica::sphere {

/// Rotation of the moving maps after which they agree best with the target's: the least weighed
/// mean of squared differences over all rotations.
[[nodiscard]] Eigen::Matrix3d searchRotation(const std::vector<FoldingLevel>& moving,
                                             const std::vector<FoldingLevel>& target,
                                             const Monitor& monitor);

}  // namespace explica::sphere
