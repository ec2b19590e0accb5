// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Core/Volume.h"

#include <functional>

namespace explica::surface {

using VertexKeys = Eigen::Matrix<Label, Eigen::Dynamic, 1>;  ///< V

/// Label of an atlas at each vertex of a ribbon: that of the voxel at half depth, else at a quarter
/// and three quarters, else at the white and the outer surface; 0 where none of them counts.
/// @param counts  which labels are cortical regions
[[nodiscard]] VertexKeys labelsWithin(const Volume<Label>& atlas, const Positions& white,
                                      const Positions& pial,
                                      const std::function<bool(Label)>& counts);

}  // namespace explica::surface
