// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/SlicePicture.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Report/Drawing.h"

#include <algorithm>
#include <cmath>

namespace explica::report {
namespace {

/// World axes of a slice: normal, and which way the picture's right and up run.
struct PlaneAxes {
  int normal;
  int right;
  double rightSign;
  int up;
};

PlaneAxes axesOf(SliceAxis axis) {
  switch (axis) {
    case SliceAxis::Sagittal:
      return {0, 1, -1, 2};
    case SliceAxis::Coronal:
      return {1, 0, 1, 2};
    default:
      return {2, 0, 1, 1};
  }
}

/// World point of a pixel position.
Point worldOf(const SliceFrame& frame, const PlaneAxes& axes, double x, double y) {
  Point p;
  p[axes.normal] = frame.position;
  p[axes.right] = frame.centre[0] + axes.rightSign * frame.pixel * (x - 0.5 * frame.width);
  p[axes.up] = frame.centre[1] - frame.pixel * (y - 0.5 * frame.height);
  return p;
}

Eigen::Vector2d pixelOf(const SliceFrame& frame, const PlaneAxes& axes, const Point& p) {
  return {axes.rightSign * (p[axes.right] - frame.centre[0]) / frame.pixel + 0.5 * frame.width,
          -(p[axes.up] - frame.centre[1]) / frame.pixel + 0.5 * frame.height};
}

/// Trilinear value; not-a-number beyond half a voxel outside the grid.
double sample(const Volume<float>& image, const Vector& index) {
  std::array<int, 3> low;
  std::array<int, 3> high;
  std::array<double, 3> share;
  for (int a = 0; a < 3; ++a) {
    const int last = image.grid.size[a] - 1;
    if (index[a] < -0.5 || index[a] > last + 0.5) return kNaN;
    const double x = std::clamp(index[a], 0.0, static_cast<double>(last));
    low[a] = std::min(static_cast<int>(x), std::max(0, last - 1));
    high[a] = std::min(low[a] + 1, last);
    share[a] = x - low[a];
  }
  double sum = 0;
  for (int c = 0; c < 8; ++c) {
    const double weight = ((c & 1) != 0 ? share[0] : 1 - share[0]) *
                          ((c & 2) != 0 ? share[1] : 1 - share[1]) *
                          ((c & 4) != 0 ? share[2] : 1 - share[2]);
    if (weight == 0) continue;
    sum += weight * image((c & 1) != 0 ? high[0] : low[0], (c & 2) != 0 ? high[1] : low[1],
                          (c & 4) != 0 ? high[2] : low[2]);
  }
  return sum;
}

/// Cut lines of a mesh with the slice's plane.  A vertex exactly on the plane counts as above it.
std::vector<Segment2> cutLines(const TriangleMesh& mesh, const SliceFrame& frame,
                               const PlaneAxes& axes) {
  std::vector<Segment2> lines;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    std::array<Point, 3> corner;
    std::array<bool, 3> above;
    for (int k = 0; k < 3; ++k) {
      corner[k] = mesh.corner(f, k);
      above[k] = corner[k][axes.normal] >= frame.position;
    }
    if (above[0] == above[1] && above[1] == above[2]) continue;
    std::array<Eigen::Vector2d, 2> ends;
    int count = 0;
    for (int k = 0; k < 3; ++k) {
      const int n = (k + 1) % 3;
      if (above[k] == above[n]) continue;
      const double a = corner[k][axes.normal] - frame.position;
      const double b = corner[n][axes.normal] - frame.position;
      ends[count++] = pixelOf(frame, axes, corner[k] + a / (a - b) * (corner[n] - corner[k]));
    }
    lines.push_back({ends[0], ends[1]});
  }
  return lines;
}

}  // namespace

SliceFrame frameAround(SliceAxis axis, double position, const Point& low, const Point& high,
                       int height) {
  const PlaneAxes axes = axesOf(axis);
  constexpr double kMargin = 1.06;
  SliceFrame frame;
  frame.axis = axis;
  frame.position = position;
  frame.centre = {0.5 * (low[axes.right] + high[axes.right]), 0.5 * (low[axes.up] + high[axes.up])};
  frame.height = height;
  frame.pixel = kMargin * (high[axes.up] - low[axes.up]) / height;
  frame.width =
      static_cast<int>(std::lround(kMargin * (high[axes.right] - low[axes.right]) / frame.pixel));
  return frame;
}

Picture renderSlice(const Volume<float>& image, const SliceFrame& frame, const ColourScale& scale,
                    const std::vector<Contour>& contours) {
  const PlaneAxes axes = axesOf(frame.axis);
  Picture picture(frame.width, frame.height, {0, 0, 0});
  parallelFor(static_cast<std::size_t>(frame.height), 16, [&](std::size_t y) {
    for (int x = 0; x < frame.width; ++x) {
      const Point world = worldOf(frame, axes, x + 0.5, static_cast<double>(y) + 0.5);
      const double value = sample(image, image.grid.toIndex(world));
      if (std::isnan(value)) continue;
      const Colour colour = scale(value);
      for (int c = 0; c < 3; ++c) picture.pixel(x, static_cast<int>(y))[c] = encodeSrgb(colour[c]);
    }
  });
  for (const Contour& contour : contours) {
    drawSegments(picture, cutLines(*contour.mesh, frame, axes), contour.colour, contour.width);
  }
  return picture;
}

Picture renderLabelSlice(const Volume<Label>& labels, const SliceFrame& frame) {
  const PlaneAxes axes = axesOf(frame.axis);
  Picture picture(frame.width, frame.height, {0, 0, 0});
  parallelFor(static_cast<std::size_t>(frame.height), 16, [&](std::size_t y) {
    for (int x = 0; x < frame.width; ++x) {
      const Vector index =
          labels.grid.toIndex(worldOf(frame, axes, x + 0.5, static_cast<double>(y) + 0.5));
      const int i = static_cast<int>(std::lround(index.x()));
      const int j = static_cast<int>(std::lround(index.y()));
      const int k = static_cast<int>(std::lround(index.z()));
      if (!labels.grid.contains(i, j, k) || labels(i, j, k) == 0) continue;
      const Colour colour = colourOfLabel(labels(i, j, k));
      for (int c = 0; c < 3; ++c) picture.pixel(x, static_cast<int>(y))[c] = encodeSrgb(colour[c]);
    }
  });
  return picture;
}

}  // namespace explica::report
