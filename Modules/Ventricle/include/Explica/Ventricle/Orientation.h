// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Ventricle/LongAxis.h"

#include <array>
#include <optional>

namespace explica::ventricle {

/// A direction within the slices of the image.
enum class ImageAxis { IPlus, IMinus, JPlus, JMinus };
constexpr auto enumWords(ImageAxis) {
  using enum ImageAxis;
  return std::to_array<EnumWord<ImageAxis>>(
      {{IPlus, "i+"}, {IMinus, "i-"}, {JPlus, "j+"}, {JMinus, "j-"}});
}

/// Where segments begin to be counted around the axis.
struct OrientationOptions {
  std::optional<Point> insertion;      ///< anterior insertion of the right ventricle, RAS mm
  std::optional<ImageAxis> imageAxis;  ///< towards it from the cavity's middle
};

template <class Visitor>
void describe(OrientationOptions& options, Visitor&& visit) {
  visit(Field{"rv-insertion", "mm",
              "point where the right ventricle's anterior wall joins the left one, RAS (default: "
              "from the label of the right ventricle)"},
        options.insertion);
  visit(Field{"rv-insertion-image-axis", "",
              "in place of a point: direction of the image in which it lies from the cavity's "
              "middle, i+ for growing column numbers, j+ for growing row numbers"},
        options.imageAxis);
}

/// How the anterior insertion was found.
enum class OrientationSource { RightVentricle, Point, ImageAxis, None };
constexpr auto enumWords(OrientationSource) {
  using enum OrientationSource;
  return std::to_array<EnumWord<OrientationSource>>({{RightVentricle, "right ventricle"},
                                                     {Point, "point"},
                                                     {ImageAxis, "image axis"},
                                                     {None, "none"}});
}

/// The direction from which the segments' angles are counted.
struct Orientation {
  OrientationSource source = OrientationSource::None;
  Vector anterior = Vector(1, 0, 0);  ///< from the axis to the anterior insertion, RAS, unit,
                                      ///< perpendicular to the axis
  double septumDeg = kNaN;            ///< angle over which the right ventricle touches the wall

  /// Degrees in [0, 360) from the anterior insertion towards the septum, which is counter-clockwise
  /// seen from the apex.
  [[nodiscard]] double angleDeg(const LongAxis& axis, const Point& x, const Point& middle) const;
};

/// With the right ventricle's label, the septum is where it touches the wall in the basal and
/// middle thirds; its middle is put between segments 2 and 3 (8 and 9), so that both insertions
/// count.  A point or an image axis that is given goes before it.  Without any, angles are counted
/// from the direction of the image that is most anterior, and the source says None.
/// @throws InvalidInput  a point on the axis or further than 20 mm from the wall
[[nodiscard]] Orientation findOrientation(const Volume<Label>& heart, const LongAxis& axis,
                                          const OrientationOptions& options = {});

}  // namespace explica::ventricle
