// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Text.h"
#include "Explica/Correspondence/Trajectory.h"
#include "Explica/Report/Canvas.h"
#include "Explica/Report/Mosaic.h"
#include "Explica/Ventricle/Pictures.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace explica::ventricle {

namespace {

using report::Canvas;
using report::Colour;
using report::kGrey;
using report::kInk;
using report::Point2;

constexpr double kTile = 230, kCaption = 40, kHead = 84;  // pixels
// Tiles a row, tiles, lines a slice.
constexpr int kColumns = 4, kMostSlices = 12, kTrajectories = 36;

constexpr Colour kWallColour = {0.84F, 0.74F, 0.62F};  // pale, so that lines show
// Red, blue.
constexpr Colour kInnerLine = {0.55F, 0.03F, 0.03F}, kOuterLine = {0.02F, 0.09F, 0.42F};
constexpr Colour kInnerOnImage = {1, 0.12F, 0.08F}, kOuterOnImage = {0.05F, 0.6F, 1};
constexpr Colour kPathLine = {0.05F, 0.26F, 0.12F};  // green

/// Colour of what is left out, by LeftOut.
Colour colourOf(LeftOut why) {
  switch (why) {
    case LeftOut::None:
      return kWallColour;
    case LeftOut::Opening:
      return {0.87F, 0.30F, 0.02F};
    case LeftOut::Valve:
      return {0.60F, 0.12F, 0.42F};
    case LeftOut::Cap:
      return {0.10F, 0.42F, 0.62F};
    default:
      return {0.35F, 0.35F, 0.35F};
  }
}

/// From the world to a tile: seen from the apex, the anterior insertion at 120 degrees as in the
/// bull's-eye.
struct View {
  Point middle;
  Vector right, up;
  double scale = 1;
  Point2 corner;
  [[nodiscard]] Point2 at(const Point& x) const {
    const Vector v = x - middle;
    return corner + Point2(0.5 * kTile + scale * v.dot(right), 0.5 * kTile - scale * v.dot(up));
  }
};

View viewOf(const Beat& beat, const Frame& frame) {
  View view;
  const Vector a = beat.orientation.anterior, b = frame.axis.direction.cross(a);
  const double turn = 120 * kPi / 180;
  view.right = std::cos(turn) * a - std::sin(turn) * b;
  view.up = std::sin(turn) * a + std::cos(turn) * b;
  double reach = 1;
  for (std::size_t v = 0; v < frame.heart.size(); ++v) {
    if (frame.heart[v] != kWall) continue;
    const Point x = centreOf(frame.heart.grid, v);
    reach = std::max(reach, (x - frame.axis.foot(x)).norm());
  }
  view.scale = 0.44 * kTile / reach;
  return view;
}

/// White at the brightest of the heart, so that fat around it does not leave it dim.
report::ColourScale greyOf(const Volume<float>& image, const Volume<Label>& heart) {
  Volume<float> subject(heart.grid);
  std::copy(heart.data.begin(), heart.data.end(), subject.data.begin());
  return report::greyScale(image, &subject);
}

/// A slice of the image as the tile shows it, two pixels a pixel of the drawing.
report::Picture imageOf(const View& view, const Volume<float>& image,
                        const report::ColourScale& grey, int k) {
  const Point origin = image.grid.toWorld(Vector(0, 0, k));
  const Vector i = image.grid.toWorld(Vector(1, 0, k)) - origin;
  const Vector j = image.grid.toWorld(Vector(0, 1, k)) - origin;
  Eigen::Matrix2d seen;
  seen << i.dot(view.right), j.dot(view.right), i.dot(view.up), j.dot(view.up);
  const Eigen::Matrix2d unseen = seen.inverse();
  const int side = static_cast<int>(2 * kTile);
  return report::renderPoints(image, side, side, grey, [&](double x, double y) {
    const Point2 at = unseen * Point2(x - kTile, kTile - y) / (2 * view.scale);
    return Point(view.middle + at[0] * i + at[1] * j);
  });
}

/// Pixels of a slice, each run of equal reason one quadrilateral.
void drawWall(Canvas& canvas, const View& view, const Frame& frame, int k) {
  const Volume<std::uint8_t>& reasons = frame.measures->reasons;
  const Grid& grid = reasons.grid;
  for (int j = 0; j < grid.size[1]; ++j) {
    for (int i = 0; i < grid.size[0];) {
      const std::uint8_t why = reasons(i, j, k);
      int end = i + 1;
      while (end < grid.size[0] && reasons(end, j, k) == why) ++end;
      if (why != 255) {
        const auto corner = [&](double x, double y) {
          return view.at(grid.toWorld(Vector(x, y, k)));
        };
        canvas.fill({corner(i - 0.5, j - 0.5), corner(end - 0.5, j - 0.5),
                     corner(end - 0.5, j + 0.5), corner(i - 0.5, j + 0.5)},
                    colourOf(static_cast<LeftOut>(why)));
      }
      i = end;
    }
  }
}

/// Tissue numbers of a slice in the order of their angle around the axis.
std::vector<std::int32_t> aroundAxis(const Beat& beat, const Frame& frame, int k) {
  const WallThickness& wall = *frame.measures;
  std::vector<std::pair<double, std::int32_t>> sorted;
  for (std::size_t n = 0; n < wall.plain.size(); ++n) {
    const auto number = static_cast<std::int32_t>(n);
    if (std::isnan(wall.plain[n]) || std::lround(wall.annulus.index(number)[2]) != k) continue;
    const Point x = wall.annulus.world(number);
    sorted.emplace_back(beat.orientation.angleDeg(frame.axis, x, frame.axis.foot(x)), number);
  }
  std::sort(sorted.begin(), sorted.end());
  std::vector<std::int32_t> numbers;
  for (const auto& [angle, number] : sorted) numbers.push_back(number);
  return numbers;
}

/// The boundary through the ends of trajectories of voxels beside it, with gaps where it is open.
void drawBoundary(Canvas& canvas, const View& view, const WallThickness& wall,
                  const std::vector<std::int32_t>& numbers, bool inner, const Colour& colour) {
  const double pixel = wall.annulus.grid.spacing.head<2>().maxCoeff();
  std::vector<std::pair<double, Point>> ends;
  for (const std::int32_t n : numbers) {
    const double distance =
        inner ? wall.correspondence.innerDistance[n] : wall.correspondence.outerDistance[n];
    if (distance > 1.2 * pixel) continue;
    const auto& offset =
        inner ? wall.correspondence.innerPoint[n] : wall.correspondence.outerPoint[n];
    const Point p = wall.annulus.world(n) + offset.cast<double>();
    const Point2 q = view.at(p) - view.corner - Point2(0.5 * kTile, 0.5 * kTile);
    ends.emplace_back(std::atan2(q[1], q[0]), p);
  }
  std::sort(ends.begin(), ends.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Point2> line;
  const auto flush = [&] {
    if (line.size() > 1) canvas.stroke(line, colour, 1.6);
    line.clear();
  };
  for (std::size_t e = 0; e <= ends.size() && !ends.empty(); ++e) {
    const Point& p = ends[e % ends.size()].second;
    const Point& before = ends[(e + ends.size() - 1) % ends.size()].second;
    if (e > 0 && (p - before).norm() > 4 * pixel) flush();
    line.push_back(view.at(p));
  }
  flush();
}

/// A trajectory from the inner to the outer boundary through a voxel's centre.
std::vector<Point> pathThrough(const WallThickness& wall,
                               const correspondence::TrajectoryTracer& tracer, std::int32_t n) {
  const Point x = wall.annulus.world(n);
  const double step = 0.5 * wall.annulus.grid.spacing.head<2>().minCoeff();
  std::vector<Point> path;
  const auto follow = [&](double sign, double length) {
    std::vector<Point> half = {x};
    for (double s = step; s < length; s += step) {
      const auto direction = tracer.direction(half.back());
      if (!direction) break;
      half.emplace_back(half.back() + sign * step * *direction);
    }
    return half;
  };
  const auto down = follow(-1, wall.correspondence.innerDistance[n]);
  const auto up = follow(1, wall.correspondence.outerDistance[n]);
  path.emplace_back(x + wall.correspondence.innerPoint[n].cast<double>());
  path.insert(path.end(), down.rbegin(), down.rend());
  path.insert(path.end(), up.begin() + 1, up.end());
  path.emplace_back(x + wall.correspondence.outerPoint[n].cast<double>());
  return path;
}

/// In each of the evenly spaced sectors, the trajectory through the voxel nearest to half depth.
void drawTrajectories(Canvas& canvas, const View& view, const Beat& beat, const Frame& frame,
                      const correspondence::TrajectoryTracer& tracer,
                      const std::vector<std::int32_t>& numbers) {
  const WallThickness& wall = *frame.measures;
  std::array<std::int32_t, kTrajectories> best{};
  best.fill(-1);
  std::array<double, kTrajectories> off{};
  for (const std::int32_t n : numbers) {
    if (!wall.counts(static_cast<std::size_t>(n))) continue;
    const Point x = wall.annulus.world(n);
    const double angle = beat.orientation.angleDeg(frame.axis, x, frame.axis.foot(x));
    const auto sector = static_cast<std::size_t>(angle / 360 * kTrajectories);
    const double from =
        std::abs(wall.correspondence.innerDistance[n] - wall.correspondence.outerDistance[n]);
    if (best[sector] >= 0 && from >= off[sector]) continue;
    best[sector] = n;
    off[sector] = from;
  }
  for (const std::int32_t n : best) {
    if (n < 0) continue;
    std::vector<Point2> line;
    for (const Point& p : pathThrough(wall, tracer, n)) line.push_back(view.at(p));
    canvas.stroke(line, kPathLine, 1);
  }
}

/// Rows of slices from base to apex, at most kMostSlices of them.
std::vector<SliceRow> shownRows(const Frame& frame) {
  std::vector<SliceRow> rows = sliceRows(frame);
  std::erase_if(rows, [](const SliceRow& r) { return r.kind == SliceKind::CavityOnly; });
  if (frame.heart.grid.direction.col(2).dot(frame.axis.direction) < 0) {
    std::reverse(rows.begin(), rows.end());
  }
  if (rows.size() <= kMostSlices) return rows;
  std::vector<SliceRow> some;
  for (std::size_t q = 0; q < kMostSlices; ++q) {
    some.push_back(rows[q * (rows.size() - 1) / (kMostSlices - 1)]);
  }
  return some;
}

std::string captionOf(const SliceRow& row) {
  return std::isfinite(row.thickness) ? printed("slice %d: %.1f mm", row.slice, row.thickness)
                                      : "slice " + std::to_string(row.slice) + ": no ring";
}

std::string secondLine(const SliceRow& row) {
  if (row.leftOut == 0) return "all " + std::to_string(row.counted) + " voxels count";
  return std::to_string(row.leftOut) + " of " + std::to_string(row.leftOut + row.counted) +
         " voxels left out";
}

void drawHead(Canvas& canvas, const Frame& frame, const char* phase, bool onImage) {
  const double middle = 0.5 * canvas.width();
  canvas.text({middle, 26},
              "Slices from base to apex, frame " + std::to_string(frame.number) + phase, 11, kInk);
  canvas.text({middle, 44},
              onImage ? "seen from the apex, boundaries on the image"
                      : "seen from the apex, trajectories drawn across the wall",
              7.5, kGrey);
  std::vector<std::pair<Colour, const char*>> legend = {
      {onImage ? kInnerOnImage : kInnerLine, "inner boundary"},
      {onImage ? kOuterOnImage : kOuterLine, "outer boundary"}};
  if (!onImage) {
    legend.insert(legend.end(), {{kWallColour, "counts"},
                                 {colourOf(LeftOut::Opening), "left out: opening"},
                                 {colourOf(LeftOut::Valve), "valve plane"},
                                 {colourOf(LeftOut::Cap), "apical cap"}});
  }
  double width = 0;
  for (const auto& [colour, words] : legend) width += 34 + report::textWidth(words, 7.5);
  double x = middle - 0.5 * width;
  for (const auto& [colour, words] : legend) {
    canvas.rectangle({x, 58}, {12, 9}, colour);
    canvas.text({x + 17, 66}, words, 7.5, kInk, report::TextAnchor::Left);
    x += 34 + report::textWidth(words, 7.5);
  }
}

/// A slice in its tile: both boundaries, on what is measured or on the image.
void drawSlice(Canvas& canvas, const View& view, const Beat& beat, const Frame& frame, int k,
               const correspondence::TrajectoryTracer& tracer, const Volume<float>* image,
               const report::ColourScale& grey) {
  const WallThickness& wall = *frame.measures;
  const auto numbers = aroundAxis(beat, frame, k);
  if (image) {
    canvas.image(view.corner, Point2(kTile, kTile), imageOf(view, *image, grey, k));
  } else {
    drawWall(canvas, view, frame, k);
    drawTrajectories(canvas, view, beat, frame, tracer, numbers);
  }
  drawBoundary(canvas, view, wall, numbers, true, image ? kInnerOnImage : kInnerLine);
  drawBoundary(canvas, view, wall, numbers, false, image ? kOuterOnImage : kOuterLine);
}

/// The slices of a frame where and as large as those of another one are.
Canvas drawSlices(const Beat& beat, std::size_t f, const Volume<float>* image,
                  const Frame& placed) {
  const Frame& frame = beat.frames[f];
  const std::vector<SliceRow> rows = shownRows(placed);
  const int lines = (static_cast<int>(rows.size()) + kColumns - 1) / kColumns;
  Canvas canvas(static_cast<int>(kColumns * kTile),
                static_cast<int>(kHead + lines * (kTile + kCaption)));
  drawHead(canvas, frame,
           f == beat.diastole  ? " (end-diastole)"
           : f == beat.systole ? " (end-systole)"
                               : "",
           image != nullptr);
  View view = viewOf(beat, placed);
  const correspondence::TrajectoryTracer tracer(frame.measures->annulus,
                                                frame.measures->interpolant);
  const auto grey = image ? greyOf(*image, frame.heart) : report::ColourScale{};
  const Grid& grid = frame.heart.grid;
  for (std::size_t q = 0; q < rows.size(); ++q) {
    const int k = rows[q].slice;
    view.corner = Point2(kTile * static_cast<double>(q % kColumns),
                         kHead + (kTile + kCaption) * static_cast<double>(q / kColumns));
    const Eigen::Vector2d centre =
        placed.measures->slices[static_cast<std::size_t>(k)].centre.cwiseQuotient(
            grid.spacing.head<2>());
    view.middle = grid.toWorld(Vector(centre[0], centre[1], k));
    drawSlice(canvas, view, beat, frame, k, tracer, image, grey);
    const Point2 below = view.corner + Point2(0.5 * kTile, kTile + 12);
    if (&placed != &frame) continue;
    canvas.text(below, captionOf(rows[q]), 8, kInk);
    canvas.text(below + Point2(0, 14), secondLine(rows[q]), 7, kGrey);
  }
  return canvas;
}

}  // namespace

Drawn slicePicture(const Beat& beat, std::size_t f, const Volume<float>* image) {
  const Canvas canvas = drawSlices(beat, f, image, beat.frames[f]);
  return {canvas.svg(), canvas.picture(2)};
}

std::string slicesOverTime(const Beat& beat, const std::vector<Volume<float>>& images) {
  constexpr double kSmall = 0.6, kPerSecond = 12;
  std::vector<report::Picture> pictures;
  for (std::size_t f = 0; f < beat.frames.size(); ++f) {
    if (!beat.frames[f].measures) continue;
    pictures.push_back(drawSlices(beat, f, &images[f], beat.atDiastole()).picture(kSmall));
  }
  return report::encodeGif(pictures, kPerSecond);
}

}  // namespace explica::ventricle
