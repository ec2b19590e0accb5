// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Report/FlatFigure.h"

#include "Explica/Core/EigenViews.h"
#include "Explica/Core/Errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

namespace explica::report {
namespace {

constexpr double kBarShare = 0.25;  // of the picture's width that the scale bar takes at most

void drawScaleBar(Canvas& canvas, double pixelsPerMillimetre) {
  const double length = roundLength(kBarShare * canvas.width() / pixelsPerMillimetre);
  const double letters = std::clamp(canvas.height() / 60.0, 9.0, 16.0);
  const Point2 from(letters, canvas.height() - 1.2 * letters);
  const Point2 to = from + Point2(length * pixelsPerMillimetre, 0);
  canvas.layer("scale");
  canvas.lines({{from, to}}, kInk, letters / 4);
  canvas.text((from + to) / 2 - Point2(0, 0.6 * letters), tickText(length, length) + " mm", letters,
              kInk);
}

/// The body's directions about a point, each with its letter at the end of a line.
void drawCompass(Canvas& canvas, const FlatMarks& marks, const Point2& middle, double letters) {
  for (const auto& [direction, letter] : marks.directions) {
    const Point2 way(direction.x(), -direction.y());  // y downwards
    canvas.lines({{middle, middle + 2 * letters * way}}, kInk, letters / 8);
    canvas.text(middle + 2.9 * letters * way + Point2(0, 0.5 * letters), letter, letters, kInk,
                TextAnchor::Middle, true);
  }
}

/// A piece of an outline in pixels, y downwards.
struct Stroke {
  Segment2 line;
  std::optional<Colour> left, right;
};

/// The pieces in the order in which one ends where the next begins, turned round for that.
std::vector<Stroke> chained(const std::vector<Stroke>& strokes) {
  const auto placeOf = [](const Point2& p) {  // to a hundredth of a pixel
    return std::pair(std::lround(100 * p.x()), std::lround(100 * p.y()));
  };
  std::multimap<std::pair<long, long>, std::size_t> endingAt;
  for (std::size_t n = 0; n < strokes.size(); ++n) {
    for (const Point2& p : {strokes[n].line.from, strokes[n].line.to}) {
      endingAt.emplace(placeOf(p), n);
    }
  }
  std::vector<Stroke> chain;
  std::vector<bool> isDone(strokes.size(), false);
  for (std::size_t first = 0; first < strokes.size(); ++first) {
    auto end = placeOf(strokes[first].line.from);
    std::optional<std::size_t> next = first;
    while (next && !isDone[*next]) {
      Stroke stroke = strokes[*next];
      isDone[*next] = true;
      if (placeOf(stroke.line.from) != end) {
        stroke = {{stroke.line.to, stroke.line.from}, stroke.right, stroke.left};
      }
      end = placeOf(stroke.line.to);
      chain.push_back(stroke);
      next.reset();
      for (auto [one, last] = endingAt.equal_range(end); one != last; ++one) {
        if (!isDone[one->second]) next = one->second;
      }
    }
  }
  return chain;
}

/// Outlines: a dark line, and on its sides the regions' colours.
void drawOutlines(Canvas& canvas, const std::vector<Stroke>& strokes, const FlatMarks& marks,
                  double width) {
  std::vector<Segment2> middle;
  std::map<Colour, std::vector<Stroke>> borders;
  for (const Stroke& stroke : chained(strokes)) {
    middle.push_back(stroke.line);
    if (stroke.left) borders[*stroke.left].push_back(stroke);
    if (stroke.right && stroke.right != stroke.left) borders[*stroke.right].push_back(stroke);
  }
  canvas.layer("outlines");
  canvas.lines(middle, kInk, 3.4 * width, "ground");
  for (const auto& [colour, border] : borders) {
    std::vector<Segment2> sides;
    for (const Stroke& stroke : chained(border)) {
      const Point2 along = stroke.line.to - stroke.line.from;
      if (!(along.norm() > 0)) continue;
      const Point2 left = Point2(along.y(), -along.x()) * (width / along.norm());
      if (stroke.left == colour) sides.push_back({stroke.line.from + left, stroke.line.to + left});
      if (stroke.right == colour) sides.push_back({stroke.line.from - left, stroke.line.to - left});
    }
    const auto name = marks.regions.find(colour);
    canvas.lines(sides, colour, width, name == marks.regions.end() ? "" : name->second);
  }
  canvas.lines(middle, kInk, 0.8 * width, "borders");
}

/// A name's box in pixels.
struct Box {
  Eigen::Vector2d low, high;
  [[nodiscard]] bool meets(const Box& other) const {
    return (low.array() < other.high.array()).all() && (other.low.array() < high.array()).all();
  }
};

/// The right corner of a picture, below or above, where more is paper.
Box freerCorner(const Picture& picture, int size) {
  const auto paperBelow = [&](int top) {
    int count = 0;
    for (int y = top; y < top + size; ++y) {
      for (int x = picture.width - size; x < picture.width; ++x) {
        count += picture.pixel(x, y)[0] == 255;
      }
    }
    return count;
  };
  const int bottom = picture.height - size;
  const Eigen::Vector2d low(picture.width - size, paperBelow(0) > paperBelow(bottom) ? 0 : bottom);
  return {low, low + Eigen::Vector2d::Constant(size)};
}

/// Names, each at its place or as near above or below as keeps it off those already written; none
/// where there is no room.
void drawNames(Canvas& canvas, const std::vector<std::pair<Eigen::Vector2d, std::string>>& names,
               std::vector<Box> taken, double letters) {
  canvas.layer("names");
  constexpr std::array kRowsAside = {0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0};
  for (const auto& [place, name] : names) {
    const double half = 0.5 * textWidth(name, letters) + 0.3 * letters;
    const double x = std::clamp(place.x(), half, std::max(half, canvas.width() - half));
    const auto boxAt = [&](double row) {
      const double y = std::clamp(place.y() + row * 1.7 * letters, 1.5 * letters,
                                  canvas.height() - 0.5 * letters);
      return Box{{x - half, y - 1.35 * letters}, {x + half, y + 0.35 * letters}};
    };
    const auto free = std::ranges::find_if(kRowsAside, [&](double row) {
      const Box box = boxAt(row);
      return std::ranges::none_of(taken, [&](const Box& b) { return b.meets(box); });
    });
    if (free == kRowsAside.end()) continue;  // a name over another can be read no more than none
    const Box box = boxAt(*free);
    taken.push_back(box);
    canvas.text({x, box.high.y() - 0.35 * letters}, name, letters, kInk, TextAnchor::Middle, true);
  }
}

}  // namespace

double roundLength(double length) {
  if (!(length > 0)) throw InvalidInput("length: must be above 0");
  const double power = std::pow(10.0, std::floor(std::log10(length)));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= length) return step * power;
  }
  return power;
}

Picture flatFigure(const TriangleMesh& mesh, const SurfacePaint& paint, const FlatMarks& marks,
                   int height) {
  return withColourBar(flatPanel(mesh, paint, marks, height).picture(), paint);
}

Canvas flatPanel(const TriangleMesh& mesh, const SurfacePaint& paint, const FlatMarks& marks,
                 int height) {
  FigureView above;
  above.towards = Vector(0, 0, -1);
  above.up = Vector(0, 1, 0);
  const Vector size = boundingBox(mesh.positions).sizes();
  SurfacePictureOptions options{
      .width = static_cast<int>(
          std::clamp(height * size.x() / std::max(size.y(), 1e-9), height / 2.0, 2.0 * height)),
      .height = height,
      .occlusion = 0};
  const Picture picture = surfaceViews(mesh, paint, {above}, options).front();
  Canvas canvas(options.width, options.height);
  canvas.layer("surfaces");
  canvas.image({0, 0}, {options.width, options.height}, picture);
  const Camera camera = cameraOf(mesh.positions, above, options.width, options.height);
  const double scale = options.height / (2 * camera.halfHeight);  // pixels a millimetre
  const auto pixelOf = [&](const Point& p) {
    return Eigen::Vector2d(options.width / 2.0 + scale * (p.x() - camera.target.x()),
                           options.height / 2.0 - scale * (p.y() - camera.target.y()));
  };
  std::vector<Stroke> strokes;
  for (const FlatLine& line : marks.lines) {
    strokes.push_back({{pixelOf(line.from), pixelOf(line.to)}, line.left, line.right});
  }
  drawOutlines(canvas, strokes, marks, height / 330.0);
  const double letters = std::clamp(height / 60.0, 9.0, 16.0);
  std::vector<Box> taken;
  if (!marks.directions.empty()) {
    taken.push_back(freerCorner(picture, static_cast<int>(9 * letters)));
  }
  std::vector<std::pair<Eigen::Vector2d, std::string>> names;
  for (const auto& [place, name] : marks.names) names.emplace_back(pixelOf(place), name);
  drawNames(canvas, names, taken, std::clamp(height / 56.0, 9.0, 18.0));
  drawScaleBar(canvas, scale);
  if (!taken.empty()) {
    drawCompass(canvas, marks, (taken.front().low + taken.front().high) / 2, letters);
  }
  return canvas;
}

}  // namespace explica::report
