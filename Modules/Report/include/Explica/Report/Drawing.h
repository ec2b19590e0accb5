// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"
#include "Explica/Report/ColourMap.h"
#include "Explica/Report/Picture.h"

#include <string>
#include <string_view>
#include <vector>

namespace explica::report {

/// A line from one pixel position to another; (0, 0) is the top left corner of the top left pixel.
struct Segment2 {
  Eigen::Vector2d from;
  Eigen::Vector2d to;
};

/// Draws lines of one colour with round ends, anti-aliased; where they overlap they do not add up.
void drawSegments(Picture& picture, const std::vector<Segment2>& segments, const Colour& colour,
                  double width);

/// Where a text stands on its position.
enum class TextAnchor { Left, Middle, Right };

/// Draws one line of text in a stroke font; characters beyond printable ASCII and a few signs of
/// units appear as '?'.
/// @param position  of the baseline's left end, middle or right end
/// @param size      height of capitals, pixels
void drawText(Picture& picture, std::string_view text, const Eigen::Vector2d& position, double size,
              const Colour& colour, TextAnchor anchor = TextAnchor::Left);

/// The same with a rim in another colour about its strokes, to be read on any ground.
void drawTextWithRim(Picture& picture, std::string_view text, const Eigen::Vector2d& position,
                     double size, const Colour& colour, const Colour& rim,
                     TextAnchor anchor = TextAnchor::Left);

inline constexpr double kRim = 0.45;  ///< width of that rim on both sides, of the capitals' height

/// Width of a text as drawn, pixels.
[[nodiscard]] double textWidth(std::string_view text, double size);

/// Where ticks of an axis stand: multiples of 1, 2 or 5 times a power of ten, about five of them.
/// @param least  the step at least; 1 for counts
[[nodiscard]] std::vector<double> roundTicks(double low, double high, double least = 0);

/// A number with as many digits as a reader needs on a range: "2.5", "-0.25", "1e-05".
[[nodiscard]] std::string tickText(double value, double range);

/// A unit as it is printed: "mm^-1" with raised digits, in UTF-8 (not for drawText()).
[[nodiscard]] std::string unitText(std::string_view unit);

}  // namespace explica::report
