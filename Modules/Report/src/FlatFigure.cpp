// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Report/FlatFigure.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

namespace explica::report {
namespace {

constexpr Colour kInk = {0.01f, 0.01f, 0.01f};  // linear light, as all colours here
constexpr Colour kPaper = {1, 1, 1};            // white
constexpr double kBarShare = 0.25;  // of the picture's width that the scale bar takes at most

void drawScaleBar(Picture& picture, double pixelsPerMillimetre, int width, int height) {
  const double length = roundLength(kBarShare * width / pixelsPerMillimetre);
  const double letters = std::clamp(height / 60.0, 9.0, 16.0);
  const Eigen::Vector2d from(letters, height - 1.2 * letters);
  const Eigen::Vector2d to = from + Eigen::Vector2d(length * pixelsPerMillimetre, 0);
  drawSegments(picture, {{from, to}}, kInk, letters / 4);
  drawText(picture, tickText(length, length) + " mm",
           (from + to) / 2 - Eigen::Vector2d(0, 0.6 * letters), letters, kInk, TextAnchor::Middle);
}

/// The body's directions about a point, each with its letter at the end of a line.
void drawCompass(Picture& picture, const FlatMarks& marks, const Eigen::Vector2d& middle,
                 double letters) {
  for (const auto& [direction, letter] : marks.directions) {
    const Eigen::Vector2d way(direction.x(), -direction.y());  // y downwards
    drawSegments(picture, {{middle, middle + 2 * letters * way}}, kInk, letters / 8);
    drawTextWithRim(picture, letter,
                    middle + 2.9 * letters * way + Eigen::Vector2d(0, 0.5 * letters), letters, kInk,
                    kPaper, TextAnchor::Middle);
  }
}

/// A piece of an outline in pixels, y downwards.
struct Stroke {
  Segment2 line;
  std::optional<Colour> left, right;
};

/// Outlines: a dark line, and on its sides the regions' colours.
void drawOutlines(Picture& picture, const std::vector<Stroke>& strokes, double width) {
  std::vector<Segment2> middle;
  std::map<Colour, std::vector<Segment2>> sides;
  for (const Stroke& stroke : strokes) {
    middle.push_back(stroke.line);
    const Eigen::Vector2d along = stroke.line.to - stroke.line.from;
    if (!(along.norm() > 0)) continue;
    const Eigen::Vector2d left = Eigen::Vector2d(along.y(), -along.x()) * (width / along.norm());
    if (stroke.left)
      sides[*stroke.left].push_back({stroke.line.from + left, stroke.line.to + left});
    if (stroke.right) {
      sides[*stroke.right].push_back({stroke.line.from - left, stroke.line.to - left});
    }
  }
  drawSegments(picture, middle, kInk, 3.4 * width);
  for (const auto& [colour, segments] : sides) drawSegments(picture, segments, colour, width);
  drawSegments(picture, middle, kInk, 0.8 * width);
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
void drawNames(Picture& picture, const std::vector<std::pair<Eigen::Vector2d, std::string>>& names,
               std::vector<Box> taken, int width, double letters) {
  constexpr std::array kRowsAside = {0.0, 1.0, -1.0, 2.0, -2.0, 3.0, -3.0};
  for (const auto& [place, name] : names) {
    const double half = 0.5 * textWidth(name, letters) + 0.3 * letters;
    const double x = std::clamp(place.x(), half, std::max(half, width - half));
    const auto boxAt = [&](double row) {
      const double y = std::clamp(place.y() + row * 1.7 * letters, 1.5 * letters,
                                  picture.height - 0.5 * letters);
      return Box{{x - half, y - 1.35 * letters}, {x + half, y + 0.35 * letters}};
    };
    const auto free = std::ranges::find_if(kRowsAside, [&](double row) {
      const Box box = boxAt(row);
      return std::ranges::none_of(taken, [&](const Box& b) { return b.meets(box); });
    });
    if (free == kRowsAside.end()) continue;  // a name over another can be read no more than none
    const Box box = boxAt(*free);
    taken.push_back(box);
    drawTextWithRim(picture, name, {x, box.high.y() - 0.35 * letters}, letters, kInk, kPaper,
                    TextAnchor::Middle);
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
  return withColourBar(flatPanel(mesh, paint, marks, height), paint);
}

Picture flatPanel(const TriangleMesh& mesh, const SurfacePaint& paint, const FlatMarks& marks,
                  int height) {
  FigureView above;
  above.towards = Vector(0, 0, -1);
  above.up = Vector(0, 1, 0);
  const Vector size =
      (mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff()).transpose();
  SurfacePictureOptions options{
      .width = static_cast<int>(
          std::clamp(height * size.x() / std::max(size.y(), 1e-9), height / 2.0, 2.0 * height)),
      .height = height,
      .occlusion = 0};
  Picture picture = surfaceViews(mesh, paint, {above}, options).front();
  const Camera camera = cameraOf(mesh, above, options.width, options.height);
  const double scale = options.height / (2 * camera.halfHeight);  // pixels a millimetre
  const auto pixelOf = [&](const Point& p) {
    return Eigen::Vector2d(options.width / 2.0 + scale * (p.x() - camera.target.x()),
                           options.height / 2.0 - scale * (p.y() - camera.target.y()));
  };
  std::vector<Stroke> strokes;
  for (const FlatLine& line : marks.lines) {
    strokes.push_back({{pixelOf(line.from), pixelOf(line.to)}, line.left, line.right});
  }
  drawOutlines(picture, strokes, height / 330.0);
  const double letters = std::clamp(height / 60.0, 9.0, 16.0);
  std::vector<Box> taken;
  if (!marks.directions.empty()) {
    taken.push_back(freerCorner(picture, static_cast<int>(9 * letters)));
  }
  std::vector<std::pair<Eigen::Vector2d, std::string>> names;
  for (const auto& [place, name] : marks.names) names.emplace_back(pixelOf(place), name);
  drawNames(picture, names, taken, options.width, std::clamp(height / 56.0, 9.0, 18.0));
  drawScaleBar(picture, scale, options.width, options.height);
  if (!taken.empty()) {
    drawCompass(picture, marks, (taken.front().low + taken.front().high) / 2, letters);
  }
  return picture;
}

}  // namespace explica::report
