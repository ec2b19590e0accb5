// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"

namespace explica::registration {

/// Mean and standard deviation of one tissue's brightness; white matter has 1.
struct BrightnessLevel {
  double mean = 0;
  double deviation = 0;
};

/// What is learnt from the image at hand about brightness near the brain's border.
struct BrainBrightness {
  Volume<float> relative;  ///< the image over the brightness of white matter nearby
  BrightnessLevel fluid;   ///< deep in the brain: ventricles, cisterns
  BrightnessLevel bone;    ///< what is dark around the brain: the inner table of the skull, air
};

/// Evens the image by white matter and measures what is dark in and around the brain.
/// @param distance  signed distance to the expected border of the brain, mm, negative inside
[[nodiscard]] BrainBrightness measureBrightness(const Volume<float>& image,
                                                const Volume<float>& distance);

}  // namespace explica::registration
