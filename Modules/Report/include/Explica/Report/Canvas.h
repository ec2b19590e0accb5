// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/Drawing.h"
#include "Explica/Report/Picture.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::report {

using Point2 = Eigen::Vector2d;

/// A drawing that is written as SVG and as pixels alike.  (0, 0) is the top left corner, in pixels
/// of the SVG, where lines are paths and words text.
class Canvas {
 public:
  Canvas(int width, int height) : width_(width), height_(height) {}

  /// What is drawn from here on is of a layer that Inkscape shows by this name.
  void layer(std::string name) { layer_ = std::move(name); }
  void fill(std::vector<Point2> outline, const Colour& colour);
  void stroke(const std::vector<Point2>& line, const Colour& colour, double width,
              bool closed = false);
  /// Lines that do not darken where they meet; in the SVG one path of this name, joined where one
  /// begins less than a width from where the one before ends.
  void lines(std::vector<Segment2> segments, const Colour& colour, double width,
             std::string name = "");
  /// @param size  height of capitals
  /// @param rim   white about the strokes, to be read on any ground
  void text(const Point2& at, std::string words, double size, const Colour& colour,
            TextAnchor anchor = TextAnchor::Middle, bool rim = false);
  /// A picture over a rectangle; in pixels, the nearest of it.
  void image(const Point2& corner, const Point2& size, Picture picture);
  /// All of another drawing, its top left corner there.
  void add(const Canvas& part, const Point2& corner);
  void rectangle(const Point2& corner, const Point2& size, const Colour& colour);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::string svg() const;
  /// @param scale  pixels of the picture per pixel of the SVG
  [[nodiscard]] Picture picture(double scale = 1) const;

 private:
  struct Shape {
    std::vector<Point2> points;
    Colour colour = {0, 0, 0};
    double width = 0;  ///< of lines, height of a text's capitals
    std::optional<std::string> words = {};
    std::optional<Picture> image = {};  ///< between two corners
    TextAnchor anchor = TextAnchor::Left;
    bool rim = false;
    std::string layer = {}, name = {};
    std::vector<Segment2> segments = {};
  };
  [[nodiscard]] static std::string svgOf(const Shape& shape);
  void put(Shape shape);
  int width_, height_;
  std::string layer_;
  std::vector<Shape> shapes_;
};

/// Draws a scale's colours as a standing bar with round ticks at its right and barTitle() above.
/// @param letters  height of capitals
void drawColourBar(Canvas& canvas, const ColourScale& scale, const Point2& corner,
                   const Point2& size, double letters);
/// "thickness [mm]"
[[nodiscard]] std::string barTitle(const ColourScale& scale);

}  // namespace explica::report
