// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/SlicePicture.h"

#include "Explica/Core/Parallel.h"
#include "Explica/Core/VoxelSets.h"
#include "Explica/Report/Drawing.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace explica::report {
namespace {

/// World axes of a slice: normal, and which way the picture's right and up run.
struct PlaneAxes {
  int normal;
  int right;
  double rightSign;
  int up;
};

PlaneAxes axesOf(SliceAxis axis, bool leftOnRight = false) {
  const double sideways = leftOnRight ? -1 : 1;
  switch (axis) {
    case SliceAxis::Sagittal:
      return {0, 1, -1, 2};
    case SliceAxis::Coronal:
      return {1, 0, sideways, 2};
    default:
      return {2, 0, sideways, 1};
  }
}
PlaneAxes axesOf(const SliceFrame& frame) {
  return axesOf(frame.axis, frame.leftOnRight);
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

/// Where a mesh meets the slice's plane: a face's piece runs from one of its edges to another, and
/// an edge has one point.  A vertex exactly on the plane counts as above it.
struct Cut {
  using Edge = std::pair<std::int32_t, std::int32_t>;
  std::map<Edge, Eigen::Vector2d> points;
  std::vector<std::array<Edge, 2>> pieces;
};

Cut cutOf(const TriangleMesh& mesh, const SliceFrame& frame, const PlaneAxes& axes) {
  Cut cut;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    std::array<double, 3> height;
    for (int k = 0; k < 3; ++k) height[k] = mesh.corner(f, k)[axes.normal] - frame.position;
    if ((height[0] >= 0) == (height[1] >= 0) && (height[1] >= 0) == (height[2] >= 0)) continue;
    std::array<Cut::Edge, 2> ends;
    int count = 0;
    for (int k = 0; k < 3; ++k) {
      const int n = (k + 1) % 3;
      if ((height[k] >= 0) == (height[n] >= 0)) continue;
      const Cut::Edge edge = std::minmax(mesh.faces(f, k), mesh.faces(f, n));
      const Point from = mesh.corner(f, k), to = mesh.corner(f, n);
      cut.points.try_emplace(
          edge, pixelOf(frame, axes, from + height[k] / (height[k] - height[n]) * (to - from)));
      ends[count++] = edge;
    }
    cut.pieces.push_back(ends);
  }
  return cut;
}

std::vector<Segment2> cutLines(const TriangleMesh& mesh, const SliceFrame& frame,
                               const PlaneAxes& axes) {
  const Cut cut = cutOf(mesh, frame, axes);
  std::vector<Segment2> lines;
  for (const auto& [from, to] : cut.pieces) {
    lines.push_back({cut.points.at(from), cut.points.at(to)});
  }
  return lines;
}

/// Pixels of the colours at their middles; black where there is none.
template <class ColourAt>
Picture drawn(int width, int height, const ColourAt& colourAt) {
  Picture picture(width, height, {0, 0, 0});
  parallelFor(static_cast<std::size_t>(height), 16, [&](std::size_t y) {
    for (int x = 0; x < width; ++x) {
      const std::optional<Colour> colour = colourAt(x + 0.5, static_cast<double>(y) + 0.5);
      for (int c = 0; colour && c < 3; ++c) {
        picture.pixel(x, static_cast<int>(y))[c] = encodeSrgb((*colour)[c]);
      }
    }
  });
  return picture;
}

}  // namespace

SliceFrame frameAround(SliceAxis axis, double position, const Point& low, const Point& high,
                       int height) {
  const PlaneAxes axes = axesOf(axis);
  constexpr double kMargin = 1.06;
  SliceFrame frame{
      .axis = axis,
      .position = position,
      .centre = {0.5 * (low[axes.right] + high[axes.right]), 0.5 * (low[axes.up] + high[axes.up])},
      .pixel = kMargin * (high[axes.up] - low[axes.up]) / height,
      .height = height};
  frame.width =
      static_cast<int>(std::lround(kMargin * (high[axes.right] - low[axes.right]) / frame.pixel));
  return frame;
}

Picture renderPoints(const Volume<float>& image, int width, int height, const ColourScale& scale,
                     const std::function<Point(double x, double y)>& worldOf) {
  return drawn(width, height, [&](double x, double y) -> std::optional<Colour> {
    const double value = sample(image, image.grid.toIndex(worldOf(x, y)));
    if (std::isnan(value)) return {};
    return scale(value);
  });
}

Picture renderSlice(const Volume<float>& image, const SliceFrame& frame, const ColourScale& scale,
                    const std::vector<Contour>& contours) {
  const PlaneAxes axes = axesOf(frame);
  Picture picture = renderPoints(image, frame.width, frame.height, scale,
                                 [&](double x, double y) { return worldOf(frame, axes, x, y); });
  for (const Contour& contour : contours) {
    drawSegments(picture, cutLines(*contour.mesh, frame, axes), contour.colour, contour.width);
  }
  return picture;
}

std::vector<std::vector<Eigen::Vector2d>> cutPolylines(const TriangleMesh& mesh,
                                                       const SliceFrame& frame) {
  const Cut cut = cutOf(mesh, frame, axesOf(frame));
  std::map<Cut::Edge, std::vector<std::size_t>> piecesAt;
  for (std::size_t p = 0; p < cut.pieces.size(); ++p) {
    for (const Cut::Edge& end : cut.pieces[p]) piecesAt[end].push_back(p);
  }
  std::vector<bool> used(cut.pieces.size(), false);
  const auto follow = [&](std::size_t piece, Cut::Edge from) {
    std::vector<Eigen::Vector2d> line = {cut.points.at(from)};
    for (bool more = true; more;) {
      used[piece] = true;
      from = cut.pieces[piece][0] == from ? cut.pieces[piece][1] : cut.pieces[piece][0];
      line.push_back(cut.points.at(from));
      more = false;
      for (const std::size_t next : piecesAt[from]) {
        if (used[next]) continue;
        piece = next;
        more = true;
        break;
      }
    }
    return line;
  };
  std::vector<std::vector<Eigen::Vector2d>> lines;
  // Open lines from their ends first; what is left are rings.
  for (const bool ends : {true, false}) {
    for (std::size_t p = 0; p < cut.pieces.size(); ++p) {
      for (const Cut::Edge& end : cut.pieces[p]) {
        if (!used[p] && (!ends || piecesAt[end].size() == 1)) lines.push_back(follow(p, end));
      }
    }
  }
  return lines;
}

std::array<char, 4> directionLetters(const SliceFrame& frame) {
  constexpr std::array<std::array<char, 2>, 3> kWays = {{{'L', 'R'}, {'P', 'A'}, {'I', 'S'}}};
  const PlaneAxes axes = axesOf(frame);
  const auto& across = kWays[axes.right];
  const auto& along = kWays[axes.up];
  const bool rising = axes.rightSign > 0;
  return {across[rising ? 0 : 1], across[rising ? 1 : 0], along[1], along[0]};
}

Picture renderLabelSlice(const Volume<Label>& labels, const SliceFrame& frame) {
  const PlaneAxes axes = axesOf(frame);
  return drawn(frame.width, frame.height, [&](double x, double y) -> std::optional<Colour> {
    const std::int64_t voxel = voxelAt(labels.grid, worldOf(frame, axes, x, y));
    if (voxel < 0 || labels[voxel] == 0) return {};
    return colourOfLabel(labels[voxel]);
  });
}

}  // namespace explica::report
