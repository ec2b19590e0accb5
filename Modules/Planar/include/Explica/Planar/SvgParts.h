// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/Curve.h"

#include <string>

namespace explica::planar::svg {

inline constexpr double kMargin = 18;   ///< of pages, pixels
inline constexpr int kMostColumns = 3;  ///< pictures beside each other

/// A number by a printf pattern with one double.
[[nodiscard]] std::string format(const char* pattern, double value);

/// "12.34,5.60".
[[nodiscard]] std::string pair(const Point2& page);

/// A line of text; `style` holds further attributes.
[[nodiscard]] std::string text(double x, double y, const std::string& words,
                               const std::string& style = "");

/// Head of a white page with 14-unit sans-serif text.
[[nodiscard]] std::string pageBegin(double width, double height);

/// A panel's letter and title: "(a) start".
[[nodiscard]] std::string panelTitle(double x, double y, int panel, const std::string& title);

/// A bar of a round length, at most 100 units of the page, and what it stands for.
/// @param scale  units of the page per unit of length
struct ScaleBar {
  std::string drawn;
  double width = 0;  ///< of the bar with its words, about, in units of the page
};
[[nodiscard]] ScaleBar scaleBar(double x, double y, double scale, const std::string& unit);

}  // namespace explica::planar::svg
