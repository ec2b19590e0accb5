// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Grid.h"

#include <vector>

namespace explica::segmentation {

/// What each brain voxel says about the bias field there: numerator / denominator, by weight.
struct BiasSamples {
  const std::vector<std::size_t>* voxel = nullptr;  ///< linear indices, not owned
  std::vector<float> numerator;
  std::vector<float> denominator;
};

/// Smooth positive field at the sampled voxels, of geometric mean 1: the ratio of numerator and
/// denominator after both passed a Gaussian of `width` mm.  Smoothing happens on blocks of about
/// width / 4 and is interpolated trilinearly; the field is smoother than that by construction.
[[nodiscard]] std::vector<float> fitBiasField(const Grid& grid, const BiasSamples& samples,
                                              double width);

/// A first field, without any classes: the smooth one whose removal makes the histogram of the
/// logarithms sharpest [Sled1998], residuals added up as in [Tustison2010], smoothed by Gaussian
/// windows.
/// @param intensity  at the voxels
/// @return multiplicative, geometric mean 1, at the voxels
[[nodiscard]] std::vector<float> sharpenHistogram(const Grid& grid,
                                                  const std::vector<std::size_t>& voxel,
                                                  const std::vector<float>& intensity,
                                                  double width);

}  // namespace explica::segmentation
