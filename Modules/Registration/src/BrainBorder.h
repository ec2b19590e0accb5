// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "BrainBrightness.h"
#include "Explica/Core/Volume.h"

#include <vector>

namespace explica::registration {

/// A place on the expected border of the brain, and how far along its normal the image has it.
struct BorderPlace {
  Point foot;            ///< on the expected border, RAS mm
  Vector outward;        ///< unit normal there
  double offset = 0;     ///< mm outward from the foot: expected under the posterior
  double deviation = 0;  ///< of the posterior, mm
  bool open = false;     ///< tissue on both sides of the border: nothing dark ends the brain
};

/// How far the brain's border may be from where it is expected, and what speaks for a place.
struct BorderOptions {
  double reach = 15;      ///< mm to either side
  double shell = 3;       ///< mm beyond the border in which skull is expected
  double apart = 4;       ///< mm between places
  double neighbours = 8;  ///< mm: width of the window in which places pull at each other
  int iterations = 60;
};

/// Finds the inner border of the skull from the expected border of the brain.
///
/// Along the normal of each place the image is read as fluid, grey or white matter up to the
/// border, as bone, dura or marrow within the shell beyond it, and as anything further out.  The
/// offsets x_i of all places are a Gaussian Markov field with the energy
///   sum_i -log p(profile_i | x_i) + sum_i (x_i - m)^2 / 2 s^2 + sum_i (x_i - mean_j x_j)^2 / 2
///   t^2,
/// the mean over neighbours weighed by distance; its mean-field posterior [Jordan1999] gives each
/// place an expected offset and a deviation.  m, and how often fluid and bone are met, are
/// re-estimated between the rounds (expectation-maximisation); s and t are what templates are off
/// in other heads and how smooth dura is.
///
/// @param distance  signed distance to the expected border, mm, negative inside; smooth
/// @return places in the order of the grid
[[nodiscard]] std::vector<BorderPlace> findBorder(const BrainBrightness& brightness,
                                                  const Volume<float>& distance,
                                                  const BorderOptions& options = {});

}  // namespace explica::registration
