// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"

namespace explica::segmentation {

/// How bright what lies deep in a head is, before anything else is known of it.  Deep is what is
/// further from the air around than half of the deepest point: mostly white and deep grey matter
/// with the ventricles, whether the skull is there or not.
struct HeadContrast {
  double thickest = 0;     ///< mm: longest edge of a voxel
  double skewness = 0;     ///< (q95 + q05 - 2 median) / (q95 - q05): fluid's tail is dark in a T1
  double spread = 0;       ///< (q95 - q05) / median
  double brightest = 0;    ///< 99.9th percentile over the median
  double brightShare = 0;  ///< of what is deep: above 1.8 medians
};

/// Measured on cubes of 3 mm, without the linear trend of their logarithms, in a second or less;
/// all 0 but `thickest` where nothing lies deep.
[[nodiscard]] HeadContrast measureContrast(const Volume<float>& image);

/// Brightness counts from that of air: where an image's darkest hundredth is below 0, as in one
/// scaled to mean 0 and deviation 1, it becomes 0, and so does what is darker.  Where more is about
/// 0 than below, as around a stripped brain, air is 0 already; a brain that was scaled within its
/// mask is lifted above it.  A CT stays.
/// @return what was added
float countFromAir(Volume<float>& image);

}  // namespace explica::segmentation
