// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"

namespace explica::surface {

/// What an image shows where it was cut out by a mask, whose outside is exactly 0.
struct MaskedImage {
  /// Voxels of 0 near the mask's edge continue what lies inside it: each gets the mean of its face
  /// neighbours that are known, step by step outward.
  Volume<float> image;
  Volume<float> seen;  ///< 1 where the image is known, 0 beyond the mask; empty if it has no mask

  /// From 0 to 1; one half on the faces between voxels at the mask's edge.
  [[nodiscard]] double seenAt(const Point& p) const;
};

/// Zeros that a skull stripping leaves are no fluid: where the mask ends at the cortex, the image
/// does not show where the cortex ends, and a border read from the step to 0 would lie inside the
/// mask.
/// @param reach  mm beyond the mask
[[nodiscard]] MaskedImage beyondMask(Volume<float> image, double reach);

}  // namespace explica::surface
