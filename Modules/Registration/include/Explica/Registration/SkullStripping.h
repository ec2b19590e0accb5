// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"

namespace explica::registration {

/// How a brain is separated from what surrounds it.
struct StrippingOptions {
  double closing = 10;  ///< mm: radius of the fissures that the dura spans
  double reach = 15;    ///< mm: how far the template's border may be from the brain's
};

/// A brain with its fluid, up to the skull.
struct BrainMask {
  Volume<Label> mask;     ///< 1 in the brain
  Volume<float> doubt;    ///< mm: standard deviation of the border's place within some mm of it
  double meanOffset = 0;  ///< mm from the template's border outward to the one found, in the mean
  double deviation = 0;   ///< mm: root mean square of `doubt` along the border
  double openShare = 0;   ///< of the border, where tissue goes on beyond it
};

/// The brain and its fluid in the image of a head.
///
/// The template's mask, brought there, is closed over the fissures and says roughly where the
/// border is; how far from it the border is along its normals, the image says: fluid, grey and
/// white matter up to it, bone beyond it, both as bright as they are in this image.  So the mask is
/// nowhere the template's own.
///
/// @param brain  the template's mask on the image's grid, 0 to 1
/// @throws InvalidInput  the mask lies outside of the image
[[nodiscard]] BrainMask stripSkull(const Volume<float>& image, const Volume<float>& brain,
                                   const StrippingOptions& options = {});

}  // namespace explica::registration
