// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Geometry/FaceTree.h"

namespace explica::geometry {

/// Between which numbers of single precision a point's coordinates lie.
struct NearQuery {
  float low[3], high[3];
};

/// Squared distances from a point to the boxes of a block, one a lane: none is larger than it is
/// but for the rounding of a few sums and products.
void squaredDistances(const BoxBlock& block, const NearQuery& query, float* squared);

}  // namespace explica::geometry
