// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/SvgParts.h"

#include <cmath>
#include <cstdio>

namespace explica::planar::svg {
namespace {

constexpr double kLongestBar = 100;   // pixels
constexpr double kLetterWidth = 7.5;  // of 14-unit text, about

/// The largest of 1, 2, 5 times a power of ten that is not above a length.
double roundLength(double most) {
  const double decade = std::pow(10, std::floor(std::log10(most)));
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= most) return step * decade;
  }
  return decade;
}

}  // namespace

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

std::string pair(const Point2& page) {
  return format("%.2f", page.x()) + "," + format("%.2f", page.y());
}

std::string text(double x, double y, const std::string& words, const std::string& style) {
  return "<text x=\"" + format("%.1f", x) + "\" y=\"" + format("%.1f", y) + "\" " + style + ">" +
         words + "</text>\n";
}

std::string pageBegin(double width, double height) {
  const std::string w = format("%.0f", width);
  const std::string h = format("%.0f", height);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + w + "\" height=\"" + h +
         "\" viewBox=\"0 0 " + w + " " + h +
         "\" font-family=\"sans-serif\" font-size=\"14\">\n"
         "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
}

std::string panelTitle(double x, double y, int panel, const std::string& title) {
  return text(x, y, std::string("(") + static_cast<char>('a' + panel % 26) + ") " + title,
              "font-weight=\"bold\"");
}

ScaleBar scaleBar(double x, double y, double scale, const std::string& unit) {
  const double length = roundLength(kLongestBar / scale);
  const std::string words = format("%g", length) + " " + unit;
  return {"<path d=\"M" + pair({x, y}) + " h" + format("%.2f", scale * length) +
              "\" stroke=\"#222\" stroke-width=\"2.5\"/>\n" +
              text(x + scale * length + 8, y + 5, words),
          scale * length + 8 + kLetterWidth * static_cast<double>(words.size())};
}

}  // namespace explica::planar::svg
