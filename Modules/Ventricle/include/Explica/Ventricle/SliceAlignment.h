// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Ventricle/LongAxis.h"

#include <Eigen/Core>

#include <vector>

namespace explica::ventricle {

/// How far each slice was moved within its plane, as breath holds of different depth move slices.
struct SliceAlignment {
  SliceShifts shift;
  double rms = 0;      ///< mm, root mean square over slices with a closed ring
  double largest = 0;  ///< mm
  /// Standard error, degrees, of the slope of the centroids' line: what of the jumps was a trend
  /// along the stack, were they independent and as large as those that were found.  NaN with fewer
  /// than three closed rings.
  double slopeErrorDeg = kNaN;
};

/// Rigid shifts of the slices within their planes, from the contours of all frames.
///
/// The centroids of the plane sections of an ellipsoid lie on a straight line.  Shifts of slices
/// and a line for each frame are fitted together to the centroids of what the epicardium encloses,
/// slice by slice, since one breath hold holds all frames of a slice.  A linear trend of shifts
/// cannot be told from a tilted axis and stays.
///
/// @param hearts  with this module's labels, one grid
/// @param axis    of the ventricle: slices that its base cuts take no part
/// @return shifts of 0 where fewer than three slices show a closed ring
[[nodiscard]] SliceAlignment alignSlices(const std::vector<Volume<Label>>& hearts,
                                         const LongAxis& axis);

}  // namespace explica::ventricle
