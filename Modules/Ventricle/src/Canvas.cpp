// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Canvas.h"

#include "Explica/Core/Html.h"
#include "Explica/Core/Text.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace explica::ventricle {

namespace {

using report::Colour;
using report::Picture;
using report::TextAnchor;

std::string number(double value) {
  return printed("%.2f", value);
}

std::string listOf(const std::vector<Point2>& points) {
  return joined(points, " ", [](const Point2& p) { return printed("%.2f,%.2f", p[0], p[1]); });
}

/// Where a row of sub-pixels crosses an outline, sorted.
std::vector<double> crossings(const std::vector<Point2>& outline, double y) {
  std::vector<double> at;
  for (std::size_t p = 0; p < outline.size(); ++p) {
    const Point2 &a = outline[p], &b = outline[(p + 1) % outline.size()];
    if ((a[1] <= y) == (b[1] <= y)) continue;
    at.push_back(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
  }
  std::sort(at.begin(), at.end());
  return at;
}

void blend(std::uint8_t* pixel, const Colour& colour, double share) {
  for (int c = 0; c < 3; ++c) {
    const double below = report::decodeSrgb(pixel[c]);
    pixel[c] = report::encodeSrgb(static_cast<float>(below + share * (colour[c] - below)));
  }
}

/// Even-odd, four rows of sub-pixels a pixel, exact along the rows.
void fillOutline(Picture& picture, const std::vector<Point2>& outline, const Colour& colour) {
  constexpr int kRows = 4;
  double low = kInfinity, high = -kInfinity;
  for (const Point2& p : outline) low = std::min(low, p[1]), high = std::max(high, p[1]);
  const int top = std::max(0, static_cast<int>(low));
  const int bottom = std::min(picture.height - 1, static_cast<int>(high));
  std::vector<double> share(static_cast<std::size_t>(picture.width));
  for (int y = top; y <= bottom; ++y) {
    std::fill(share.begin(), share.end(), 0.0);
    for (int row = 0; row < kRows; ++row) {
      const auto at = crossings(outline, y + (row + 0.5) / kRows);
      for (std::size_t q = 0; q + 1 < at.size(); q += 2) {
        const int first = std::max(0, static_cast<int>(at[q]));
        const int last = std::min(picture.width - 1, static_cast<int>(at[q + 1]));
        for (int x = first; x <= last; ++x) {
          const double covered = std::min(at[q + 1], x + 1.0) - std::max(at[q], double(x));
          share[x] += std::max(0.0, covered) / kRows;
        }
      }
    }
    for (int x = 0; x < picture.width; ++x) {
      if (share[x] > 0) blend(picture.pixel(x, y), colour, std::min(1.0, share[x]));
    }
  }
}

/// The picture over the rectangle, pixel by pixel the nearest.
void drawImage(Picture& onto, const Picture& image, const Point2& corner, const Point2& opposite) {
  const Point2 size = opposite - corner;
  for (int y = static_cast<int>(corner[1]); y < std::lround(opposite[1]); ++y) {
    for (int x = static_cast<int>(corner[0]); x < std::lround(opposite[0]); ++x) {
      const auto* from =
          image.pixel(static_cast<int>((x + 0.5 - corner[0]) / size[0] * image.width),
                      static_cast<int>((y + 0.5 - corner[1]) / size[1] * image.height));
      std::copy(from, from + 3, onto.pixel(x, y));
    }
  }
}

}  // namespace

void Canvas::fill(std::vector<Point2> outline, const Colour& colour) {
  shapes_.push_back({std::move(outline), colour, 0, true, {}, {}, TextAnchor::Left});
}

void Canvas::stroke(std::vector<Point2> line, const Colour& colour, double width, bool closed) {
  shapes_.push_back({std::move(line), colour, width, closed, {}, {}, TextAnchor::Left});
}

void Canvas::text(const Point2& at, std::string words, double size, const Colour& colour,
                  TextAnchor anchor) {
  shapes_.push_back({{at}, colour, size, false, std::move(words), {}, anchor});
}

void Canvas::image(const Point2& corner, const Point2& size, Picture picture) {
  shapes_.push_back({{corner, corner + size}, {}, 0, true, {}, std::move(picture)});
}

void Canvas::rectangle(const Point2& corner, const Point2& size, const Colour& colour) {
  fill({corner, corner + Point2(size[0], 0), corner + size, corner + Point2(0, size[1])}, colour);
}

std::string Canvas::svg() const {
  const std::string w = std::to_string(width_), h = std::to_string(height_);
  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + w + ' ' + h +
                    "\" width=\"" + w + "\" height=\"" + h +
                    "\" font-family=\"Helvetica, Arial, sans-serif\">\n<rect width=\"" + w +
                    "\" height=\"" + h + "\" fill=\"#ffffff\"/>\n";
  // Capitals are 0.72 of the size of these fonts.
  constexpr double kFontPerCapital = 1 / 0.72;
  for (const Shape& s : shapes_) {
    if (s.words) {
      const char* anchor = s.anchor == TextAnchor::Left     ? "start"
                           : s.anchor == TextAnchor::Middle ? "middle"
                                                            : "end";
      out += "<text x=\"" + number(s.points[0][0]) + "\" y=\"" + number(s.points[0][1]) +
             "\" font-size=\"" + number(s.width * kFontPerCapital) + "\" text-anchor=\"" + anchor +
             "\" fill=\"" + report::hexText(s.colour) + "\">" + escapeHtml(*s.words) + "</text>\n";
    } else if (s.image) {
      out += report::svgImage(*s.image, s.points[0], s.points[1] - s.points[0]);
    } else if (s.width == 0) {
      out += "<polygon points=\"" + listOf(s.points) + "\" fill=\"" + report::hexText(s.colour) +
             "\"/>\n";
    } else {
      out += std::string(s.closed ? "<polygon" : "<polyline") + " points=\"" + listOf(s.points) +
             "\" fill=\"none\" stroke=\"" + report::hexText(s.colour) + "\" stroke-width=\"" +
             number(s.width) + "\" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>\n";
    }
  }
  return out + "</svg>\n";
}

Picture Canvas::picture(double scale) const {
  Picture picture(static_cast<int>(std::lround(width_ * scale)),
                  static_cast<int>(std::lround(height_ * scale)));
  for (const Shape& s : shapes_) {
    std::vector<Point2> points;
    for (const Point2& p : s.points) points.emplace_back(scale * p);
    if (s.words) {
      report::drawText(picture, *s.words, points[0], scale * s.width, s.colour, s.anchor);
    } else if (s.image) {
      drawImage(picture, *s.image, points[0], points[1]);
    } else if (s.width == 0) {
      fillOutline(picture, points, s.colour);
    } else {
      std::vector<report::Segment2> lines;
      for (std::size_t p = 0; p + (s.closed ? 0 : 1) < points.size(); ++p) {
        lines.push_back({points[p], points[(p + 1) % points.size()]});
      }
      report::drawSegments(picture, lines, s.colour, scale * s.width);
    }
  }
  return picture;
}

Colour inkOn(const Colour& ground) {
  // Where black and white have the same contrast, (Y + 0.05)^2 = 1.05 * 0.05.
  const double light = 0.2126 * ground[0] + 0.7152 * ground[1] + 0.0722 * ground[2];
  return light > 0.18 ? kInk : kWhite;
}

}  // namespace explica::ventricle
