// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/Picture.h"
#include "Explica/Ventricle/Beat.h"

#include <string>

namespace explica::ventricle {

/// A picture as a drawing and as pixels.
struct Drawn {
  std::string svg;
  report::Picture pixels;  ///< twice as many a side as the drawing's
};

/// Bull's-eyes of the segments: thickness at end-diastole and, where it was measured, at
/// end-systole, and thickening; numbers and names of segments, values, colour bars, and the range
/// of healthy adults where one is known [Kawel2012].  Seen from the apex, anterior on top, septum
/// on the left; without orientation it says so and gives no names.
[[nodiscard]] Drawn bullseye(const Beat& beat);

/// The slices of a frame from base to apex, seen from the apex: both boundaries, trajectories
/// through evenly spaced places of the wall [thesis figure 3.3], and in other colours what is left
/// out of means.
[[nodiscard]] Drawn slicePicture(const Beat& beat, std::size_t frame);

}  // namespace explica::ventricle
