// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Canvas.h"

#include "Encoding.h"
#include "Explica/Core/Html.h"
#include "Explica/Core/Text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace explica::report {

namespace {

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
    const double below = decodeSrgb(pixel[c]);
    pixel[c] = encodeSrgb(static_cast<float>(below + share * (colour[c] - below)));
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
  const long right = std::min<long>(onto.width, std::lround(opposite[0]));
  const long bottom = std::min<long>(onto.height, std::lround(opposite[1]));
  for (int y = static_cast<int>(corner[1]); y < bottom; ++y) {
    for (int x = static_cast<int>(corner[0]); x < right; ++x) {
      const auto* from =
          image.pixel(static_cast<int>((x + 0.5 - corner[0]) / size[0] * image.width),
                      static_cast<int>((y + 0.5 - corner[1]) / size[1] * image.height));
      std::copy(from, from + 3, onto.pixel(x, y));
    }
  }
}

}  // namespace

void Canvas::put(Shape shape) {
  shape.layer = layer_;
  shapes_.push_back(std::move(shape));
}

void Canvas::fill(std::vector<Point2> outline, const Colour& colour) {
  put({std::move(outline), colour});
}

void Canvas::stroke(const std::vector<Point2>& line, const Colour& colour, double width,
                    bool closed) {
  std::vector<Segment2> segments;
  for (std::size_t p = 0; p + (closed ? 0 : 1) < line.size(); ++p) {
    segments.push_back({line[p], line[(p + 1) % line.size()]});
  }
  lines(std::move(segments), colour, width);
}

void Canvas::lines(std::vector<Segment2> segments, const Colour& colour, double width,
                   std::string name) {
  put({{}, colour, width, {}, {}, {}, false, {}, std::move(name), std::move(segments)});
}

void Canvas::text(const Point2& at, std::string words, double size, const Colour& colour,
                  TextAnchor anchor, bool rim) {
  put({{at}, colour, size, std::move(words), {}, anchor, rim});
}

void Canvas::image(const Point2& corner, const Point2& size, Picture picture) {
  put({{corner, corner + size}, {}, 0, {}, std::move(picture)});
}

void Canvas::rectangle(const Point2& corner, const Point2& size, const Colour& colour) {
  fill({corner, corner + Point2(size[0], 0), corner + size, corner + Point2(0, size[1])}, colour);
}

void Canvas::add(const Canvas& part, const Point2& corner) {
  for (Shape shape : part.shapes_) {
    for (Point2& p : shape.points) p += corner;
    for (Segment2& s : shape.segments) s = {s.from + corner, s.to + corner};
    shapes_.push_back(std::move(shape));
  }
}

std::string Canvas::svgOf(const Shape& s) {
  // Capitals are 0.72 of the size of these fonts.
  constexpr double kFontPerCapital = 1 / 0.72;
  constexpr std::array kAnchors = {"start", "middle", "end"};
  const std::string colour = hexText(s.colour);
  if (s.words) {
    const std::string rim =
        printed(" paint-order=\"stroke\" stroke=\"#ffffff\" stroke-width=\"%.2f\"", kRim * s.width);
    return printed("<text x=\"%.2f\" y=\"%.2f\" font-size=\"%.2f\" text-anchor=\"%s\" fill=\"%s\"",
                   s.points[0].x(), s.points[0].y(), s.width * kFontPerCapital,
                   kAnchors[static_cast<std::size_t>(s.anchor)], colour.c_str()) +
           (s.rim ? rim : "") + ">" + escapeHtml(*s.words) + "</text>\n";
  }
  if (s.image) {
    const Point2 corner = s.points[0], size = s.points[1] - corner;
    return printed("<image x='%g' y='%g' width='%g' height='%g' href='data:image/png;base64,",
                   corner.x(), corner.y(), size.x(), size.y()) +
           base64(encodePng(*s.image)) + "'/>\n";
  }
  if (s.segments.empty()) {
    return "<polygon points=\"" + listOf(s.points) + "\" fill=\"" + colour + "\"/>\n";
  }
  std::string path;
  Point2 end = s.segments.front().from;
  for (const Segment2& segment : s.segments) {
    const bool joins = !path.empty() && (segment.from - end).norm() < s.width;
    if (!joins || segment.from != end) path += (joins ? "L" : "M") + listOf({segment.from});
    path += "L" + listOf({segment.to});
    end = segment.to;
  }
  return "<path " + (s.name.empty() ? "" : "inkscape:label=\"" + escapeHtml(s.name) + "\" ") +
         printed(
             "fill=\"none\" stroke=\"%s\" stroke-width=\"%.2f\" stroke-linejoin=\"round\" "
             "stroke-linecap=\"round\" d=\"",
             colour.c_str(), s.width) +
         path + "\"/>\n";
}

std::string Canvas::svg() const {
  const std::string w = std::to_string(width_), h = std::to_string(height_);
  std::vector<std::pair<std::string, std::string>> layers;  // name and elements
  for (const Shape& s : shapes_) {
    auto layer = std::ranges::find(layers, s.layer, &std::pair<std::string, std::string>::first);
    if (layer == layers.end()) layer = layers.insert(layer, {s.layer, ""});
    layer->second += svgOf(s);
  }
  std::string out =
      "<svg xmlns=\"http://www.w3.org/2000/svg\" "
      "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" viewBox=\"0 0 " +
      w + ' ' + h + "\" width=\"" + w + "\" height=\"" + h +
      "\" font-family=\"Helvetica, Arial, sans-serif\">\n<rect width=\"" + w + "\" height=\"" + h +
      "\" fill=\"#ffffff\"/>\n";
  for (const auto& [name, elements] : layers) {
    out += name.empty() ? elements
                        : "<g id=\"" + name + "\" inkscape:groupmode=\"layer\" inkscape:label=\"" +
                              name + "\">\n" + elements + "</g>\n";
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
      const double size = scale * s.width;
      if (s.rim) drawTextWithRim(picture, *s.words, points[0], size, s.colour, kWhite, s.anchor);
      if (!s.rim) drawText(picture, *s.words, points[0], size, s.colour, s.anchor);
    } else if (s.image) {
      drawImage(picture, *s.image, points[0], points[1]);
    } else if (s.segments.empty()) {
      fillOutline(picture, points, s.colour);
    } else {
      std::vector<Segment2> lines = s.segments;
      for (Segment2& line : lines) line = {scale * line.from, scale * line.to};
      drawSegments(picture, lines, s.colour, scale * s.width);
    }
  }
  return picture;
}

std::string barTitle(const ColourScale& scale) {
  return scale.unit.empty() ? scale.title : scale.title + " [" + unitText(scale.unit) + "]";
}

void drawColourBar(Canvas& canvas, const ColourScale& scale, const Point2& corner,
                   const Point2& size, double letters) {
  constexpr int kSteps = 128;
  for (int n = 0; n < kSteps; ++n) {  // each reaches below the next, so that no seam shows
    const double above = size.y() * n / kSteps;
    canvas.rectangle(corner + Point2(0, above), {size.x(), size.y() - above},
                     colourAt(scale.map, 1 - (n + 0.5) / kSteps));
  }
  const double range = scale.high - scale.low;
  for (const double value : roundTicks(scale.low, scale.high)) {
    const Point2 at = corner + Point2(size.x(), (scale.high - value) / range * size.y());
    canvas.lines({{at, at + Point2(0.4 * letters, 0)}}, kInk, 1);
    canvas.text(at + Point2(0.8 * letters, 0.5 * letters), tickText(value, range), letters, kInk,
                TextAnchor::Left);
  }
  canvas.text(corner - Point2(0, letters), barTitle(scale), letters, kInk, TextAnchor::Left);
}

}  // namespace explica::report
