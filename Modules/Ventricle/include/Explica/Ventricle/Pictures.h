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
/// out of means; or both boundaries on an image of that frame.
/// @param image  on the grid of the labels; nullptr: none
[[nodiscard]] Drawn slicePicture(const Beat& beat, std::size_t frame,
                                 const Volume<float>* image = nullptr);

/// The slices of end-diastole with both boundaries on the images, over time: an endless GIF of the
/// frames that have a wall.
/// @param images  one a frame of the beat
[[nodiscard]] std::string slicesOverTime(const Beat& beat,
                                         const std::vector<Volume<float>>& images);

}  // namespace explica::ventricle
