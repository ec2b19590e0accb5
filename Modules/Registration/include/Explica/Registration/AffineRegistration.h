// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Monitor.h"
#include "Explica/Core/Volume.h"

#include <Eigen/Geometry>

namespace explica::registration {

/// An affine map that brings a template into an image's space.
struct AffineRegistration {
  Eigen::Affine3d templateToImage = Eigen::Affine3d::Identity();  ///< RAS mm
  double information = 0;  ///< normalised mutual information, 1 (none) to 2
};

/// Normalised mutual information (H(A) + H(B)) / H(A, B) [Studholme1999] of the image and the
/// mapped template over the template's region, at most, over translation, rotation, scale and
/// shear.
///
/// Coarse to fine: many starts (places along the head, tilts) at 8 mm, the best of them with more
/// and more freedom at 8, 6 and 4 mm, by directions without derivatives [Powell1964].  So it needs
/// no bright class, no common scale and no start by hand, and its sums are the same for any number
/// of threads.
///
/// @param region  on the template's grid: above 0.5 where it counts; the head around the brain, so
///                that the neck has no say
/// @throws InvalidInput  an empty region, an image without contrast
[[nodiscard]] AffineRegistration registerAffine(const Volume<float>& image,
                                                const Volume<float>& inTemplate,
                                                const Volume<float>& region,
                                                const Monitor& monitor = {});

}  // namespace explica::registration
