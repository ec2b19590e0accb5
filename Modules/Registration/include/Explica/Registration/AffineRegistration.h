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

/// How a head may lie beside the axes that its header states.
enum class Pose {
  Upright,  ///< nearly along them
  Turned    ///< turned by up to 90 degrees: it lay so, or the header is wrong by an axis
};

/// Normalised mutual information (H(A) + H(B)) / H(A, B) [Studholme1999] of the image and the
/// mapped template over the template's region, at most, over translation, rotation, scale and
/// shear.
///
/// Coarse to fine: many starts (places along the head, tilts) at 8 mm, those of a head that is
/// turned from 32 rotations at 12 mm; the best of them with more and more freedom at 8, 6 and 4 mm,
/// by directions without derivatives [Powell1964].  So it needs no bright class, no common scale
/// and no start by hand, and its sums are the same for any number of threads.
///
/// @param region  on the template's grid: above 0.5 where it counts; the head around the brain, so
///                that the neck has no say
/// @throws InvalidInput  an empty region, an image without contrast
[[nodiscard]] AffineRegistration registerAffine(const Volume<float>& image,
                                                const Volume<float>& inTemplate,
                                                const Volume<float>& region,
                                                Pose pose = Pose::Upright,
                                                const Monitor& monitor = {});

/// The rotation and translation that bring the points of an image onto those of another one of the
/// same head, of any contrast, that lies near it already: a T2 of the session beside its T1.
///
/// Climbs the same information from where the headers put both, at 4 and 2 mm, and ends where a
/// step of 0.02 mm gains nothing.
/// @param image   head or brain
/// @param second  of the same head; may show more or less of it
/// @throws InvalidInput  an image without contrast, less than half of the head in both, or nothing
/// in
///                       common, as of two heads
[[nodiscard]] Eigen::Isometry3d registerNearby(const Volume<float>& image,
                                               const Volume<float>& second,
                                               const Monitor& monitor = {});

/// Where the grid of a second image lies in the frame of the first.
/// @param motion  as registerNearby(): from the first's points to the second's
[[nodiscard]] Grid broughtBack(Grid grid, const Eigen::Isometry3d& motion);

}  // namespace explica::registration
