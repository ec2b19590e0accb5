// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/Drawing.h"
#include "Explica/Report/Picture.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::ventricle {

using Point2 = Eigen::Vector2d;

/// A drawing that is written as SVG and as pixels alike.  (0, 0) is the top left corner, in pixels
/// of the SVG.
class Canvas {
 public:
  Canvas(int width, int height) : width_(width), height_(height) {}

  void fill(std::vector<Point2> outline, const report::Colour& colour);
  void stroke(std::vector<Point2> line, const report::Colour& colour, double width,
              bool closed = false);
  /// @param size  height of capitals
  void text(const Point2& at, std::string words, double size, const report::Colour& colour,
            report::TextAnchor anchor = report::TextAnchor::Middle);
  /// A picture over a rectangle; in pixels, the nearest of it.
  void image(const Point2& corner, const Point2& size, report::Picture picture);
  void rectangle(const Point2& corner, const Point2& size, const report::Colour& colour);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::string svg() const;
  /// @param scale  pixels of the picture per pixel of the SVG
  [[nodiscard]] report::Picture picture(double scale) const;

 private:
  struct Shape {
    std::vector<Point2> points;
    report::Colour colour = {0, 0, 0};
    double width = 0;  ///< of a line, height of a text's capitals; 0 fills
    bool closed = false;
    std::optional<std::string> words;
    std::optional<report::Picture> image;  ///< between two corners
    report::TextAnchor anchor = report::TextAnchor::Left;
  };
  int width_, height_;
  std::vector<Shape> shapes_;
};

// Linear light, as all colours here.
using report::kInk;
inline constexpr report::Colour kPale = {0.78F, 0.79F, 0.80F};  // gridlines, and what is not known
inline constexpr report::Colour kGrey = {0.21F, 0.22F, 0.23F};  // small print
inline constexpr report::Colour kWhite = {1, 1, 1};             // paper

/// Black or white, whichever is read better on a colour.
[[nodiscard]] report::Colour inkOn(const report::Colour& ground);

}  // namespace explica::ventricle
