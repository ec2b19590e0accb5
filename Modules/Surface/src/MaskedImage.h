// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"

namespace explica::surface {

/// An image whose masked voxels near the mask's edge continue what lies inside it.
///
/// Zeros that a skull stripping leaves are no fluid: where the mask ends at the cortex, the image
/// does not show where the cortex ends, and a border read from the step to 0 would lie inside the
/// mask.  Each voxel of exactly 0 gets the mean of its face neighbours that are known, step by
/// step outward, so that the profile across the mask's edge is flat.
/// @param reach  mm beyond the mask
[[nodiscard]] Volume<float> beyondMask(Volume<float> image, double reach);

}  // namespace explica::surface
