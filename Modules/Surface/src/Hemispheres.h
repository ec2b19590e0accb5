// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Surface/CorticalTissue.h"
#include "Masks.h"

#include <cstdint>

namespace explica::surface {

/// One label for the whole brain is legal, and seldom what was meant: says what was found.
void warnOfTwoHemispheres(const Mask& white, const Monitor& monitor);

/// Voxel faces between the two sides (1 and 2) of a cut.
[[nodiscard]] std::int64_t contactOf(const Mask& sides);

/// Leaves one hemisphere of labels that hold both; white matter beyond the cut is insulated.
/// @return voxel faces between the hemispheres where white matter was cut
/// @throws InvalidInput  white matter does not hold two hemispheres
std::int64_t takeHemisphere(Side side, TissueMasks& masks, const Monitor& monitor);

}  // namespace explica::surface
