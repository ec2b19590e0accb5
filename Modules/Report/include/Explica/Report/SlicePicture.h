// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Describe.h"
#include "Explica/Core/TriangleMesh.h"
#include "Explica/Core/Volume.h"
#include "Explica/Report/ColourMap.h"
#include "Explica/Report/Picture.h"

#include <array>
#include <functional>
#include <vector>

namespace explica::report {

/// A plane perpendicular to one of the head's axes.
enum class SliceAxis {
  Sagittal,  ///< perpendicular to left-right; anterior to the left
  Coronal,   ///< perpendicular to back-front; the patient's left on the left
  Axial      ///< perpendicular to feet-head; the patient's left on the left, anterior up
};
constexpr auto enumWords(SliceAxis) {
  using enum SliceAxis;
  return std::to_array<EnumWord<SliceAxis>>(
      {{Sagittal, "sagittal"}, {Coronal, "coronal"}, {Axial, "axial"}});
}

/// A surface's cut line in a slice.
struct Contour {
  const TriangleMesh* mesh = nullptr;  ///< not owned
  Colour colour = {1, 0.2f, 0};
  double width = 1.6;  ///< pixels
};

/// The part of the world that a slice shows, and how large.
struct SliceFrame {
  SliceAxis axis = SliceAxis::Axial;
  double position = 0;                               ///< along the axis, RAS mm
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< of the picture, in-plane RAS mm
  double pixel = 0.5;                                ///< mm
  int width = 400;
  int height = 400;
  bool leftOnRight = false;  ///< mirrored: the patient's left on the right (coronal and axial)
};

/// A frame that holds a box of the world, RAS mm, with a margin.
[[nodiscard]] SliceFrame frameAround(SliceAxis axis, double position, const Point& low,
                                     const Point& high, int height);

/// A scalar volume at the points of the world that `worldOf` gives for places in the picture, in
/// pixels: interpolated trilinearly; beyond the volume it is black.
[[nodiscard]] Picture renderPoints(const Volume<float>& image, int width, int height,
                                   const ColourScale& scale,
                                   const std::function<Point(double x, double y)>& worldOf);

/// A slice of a scalar volume with cut lines of surfaces on it.  Any grid, oblique ones too.
[[nodiscard]] Picture renderSlice(const Volume<float>& image, const SliceFrame& frame,
                                  const ColourScale& scale,
                                  const std::vector<Contour>& contours = {});

/// The lines in which a surface meets the slice, in pixels of the picture, each as far as it can be
/// followed; a closed one ends where it begins.
[[nodiscard]] std::vector<std::vector<Eigen::Vector2d>> cutPolylines(const TriangleMesh& mesh,
                                                                     const SliceFrame& frame);

/// The letters of the head's directions at a slice's left, right, top and bottom edge.
[[nodiscard]] std::array<char, 4> directionLetters(const SliceFrame& frame);

/// A slice of labels, each in its colour; 0 is black.
[[nodiscard]] Picture renderLabelSlice(const Volume<Label>& labels, const SliceFrame& frame);

}  // namespace explica::report
