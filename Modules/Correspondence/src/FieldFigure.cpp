// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Correspondence/FieldFigure.h"

#include "Explica/Core/Errors.h"
#include "Explica/Correspondence/Trajectory.h"
#include "Explica/Planar/SvgParts.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace explica::correspondence {

using harmonic::Annulus;
using harmonic::Interpolant;

namespace {

using planar::Point2;
using planar::svg::format;
using planar::svg::kMargin;
using planar::svg::text;

constexpr double kPanel = 460;                  // SVG units, of the longer side
constexpr double kTitle = 30;                   // pixels
constexpr double kLegend = 44;                  // pixels
constexpr int kBands = 10;                      // of u
constexpr int kArrowsAcross = 34;               // along the longer side of a panel
constexpr int kPathsAcross = 16;                // trajectories along the longer side, about
constexpr const char* kInnerStyle = "#b01414";  // red
constexpr const char* kOuterStyle = "#143c9c";  // blue
constexpr const char* kPathStyle = "#0f6b3a";   // green: apart for the colour-blind, too

/// From the world to a panel, by the slice's own axes.
struct Plane {
  const Grid& grid;
  double scale = 1;                               ///< units per mm
  Eigen::Vector2d low = Eigen::Vector2d::Zero();  ///< mm along i and j
  double left = 0, top = 0;

  [[nodiscard]] Point2 at(const Point& world) const {
    const Vector index = grid.toIndex(world);
    return Point2(left, top) + scale * (index.head<2>().cwiseProduct(grid.spacing.head<2>()) - low);
  }
  [[nodiscard]] Point2 direction(const Vector& world) const {
    return (grid.direction.transpose() * world).head<2>();
  }
};

/// Tissue numbers of a slice.
std::vector<std::int32_t> tissueOf(const Annulus& annulus, int slice) {
  std::vector<std::int32_t> numbers;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    if (std::lround(annulus.index(n)[2]) == slice) numbers.push_back(n);
  }
  std::sort(numbers.begin(), numbers.end(),
            [&](std::int32_t a, std::int32_t b) { return annulus.place[a] < annulus.place[b]; });
  return numbers;
}

/// Colour of a band of u, from the inner boundary's to the outer one's.
std::string bandColour(double u) {
  const double t = (std::floor(std::clamp(u, 0.0, 0.999) * kBands) + 0.5) / kBands;
  const auto mix = [&](double a, double b) {
    return static_cast<int>(std::lround(a + t * (b - a)));
  };
  char colour[16];
  std::snprintf(colour, sizeof colour, "#%02x%02x%02x", mix(250, 88), mix(226, 120), mix(190, 196));
  return colour;
}

void drawVoxels(std::string& page, const Plane& plane, const Annulus& annulus,
                const std::vector<std::int32_t>& numbers, const std::vector<double>* u) {
  const Eigen::Vector2d h = plane.scale * annulus.grid.spacing.head<2>();
  for (const std::int32_t n : numbers) {
    const Point2 corner = plane.at(annulus.world(n)) - h / 2;
    page += "<rect x=\"" + format("%.2f", corner.x()) + "\" y=\"" + format("%.2f", corner.y()) +
            "\" width=\"" + format("%.2f", h.x() + 0.05) + "\" height=\"" +
            format("%.2f", h.y() + 0.05) + "\" fill=\"" +
            (u ? bandColour((*u)[n]) : std::string("#eef0f2")) + "\"/>\n";
  }
}

/// Ends of trajectories of the voxels beside a boundary: dots that outline it below the voxels.
void drawBoundary(std::string& page, const Plane& plane, const Annulus& annulus,
                  const std::vector<std::int32_t>& numbers, const std::vector<double>& distance,
                  const std::vector<Eigen::Vector3f>& point, const char* colour) {
  const double near = 1.2 * annulus.grid.spacing.head<2>().maxCoeff();
  for (const std::int32_t n : numbers) {
    if (!(distance[n] < near)) continue;
    const Point2 p = plane.at(annulus.world(n) + point[n].cast<double>());
    page += "<circle cx=\"" + format("%.2f", p.x()) + "\" cy=\"" + format("%.2f", p.y()) +
            "\" r=\"1.1\" fill=\"" + colour + "\"/>\n";
  }
}

/// Voxels at least `spacing` apart, taken greedily.
std::vector<std::int32_t> spread(const Annulus& annulus, const std::vector<std::int32_t>& numbers,
                                 double spacing) {
  std::vector<std::int32_t> chosen;
  for (const std::int32_t n : numbers) {
    const Point x = annulus.world(n);
    const bool far = std::all_of(chosen.begin(), chosen.end(), [&](std::int32_t m) {
      return (annulus.world(m) - x).norm() >= spacing;
    });
    if (far) chosen.push_back(n);
  }
  return chosen;
}

void drawArrows(std::string& page, const Plane& plane, const TrajectoryTracer& tracer,
                const std::vector<std::int32_t>& numbers, double spacing) {
  const double length = 0.85 * spacing * plane.scale;
  std::string path;
  for (const std::int32_t n : spread(tracer.annulus(), numbers, spacing)) {
    const Point x = tracer.annulus().world(n);
    const auto t = tracer.direction(x);
    if (!t) continue;
    const Point2 along = length * plane.direction(*t);
    const Point2 tail = plane.at(x) - along / 2, head = plane.at(x) + along / 2;
    const Point2 back = -0.35 * along, side = 0.22 * Point2(-along.y(), along.x());
    path += "M" + planar::svg::pair(tail) + " L" + planar::svg::pair(head) + " M" +
            planar::svg::pair(head + back + side) + " L" + planar::svg::pair(head) + " L" +
            planar::svg::pair(head + back - side) + " ";
  }
  page += "<path fill=\"none\" stroke=\"#333\" stroke-width=\"0.9\" d=\"" + path + "\"/>\n";
}

/// The trajectory through a voxel's centre from one boundary to the other.
std::vector<Point> pathThrough(const TrajectoryTracer& tracer, const Correspondence& found,
                               std::int32_t n) {
  const Annulus& annulus = tracer.annulus();
  const Point x = annulus.world(n);
  const double step = 0.25 * annulus.grid.spacing.head<2>().minCoeff();
  const auto follow = [&](double sign, double length) {
    std::vector<Point> half = {x};
    for (double s = step; s < length; s += step) {
      // Midpoint rule.
      const auto here = tracer.direction(half.back());
      if (!here) break;
      const auto ahead = tracer.direction(half.back() + 0.5 * sign * step * *here);
      half.emplace_back(half.back() + sign * step * ahead.value_or(*here));
    }
    return half;
  };
  const auto down = follow(-1, found.innerDistance[n]);
  const auto up = follow(1, found.outerDistance[n]);
  std::vector<Point> path = {x + found.innerPoint[n].cast<double>()};
  path.insert(path.end(), down.rbegin(), down.rend());
  path.insert(path.end(), up.begin() + 1, up.end());
  path.emplace_back(x + found.outerPoint[n].cast<double>());
  return path;
}

void drawPaths(std::string& page, const Plane& plane, const TrajectoryTracer& tracer,
               const Interpolant& interpolant, const Correspondence& found,
               const std::vector<std::int32_t>& numbers, double spacing) {
  // Voxels in the middle of the tissue first.
  std::vector<std::int32_t> sorted;
  for (const std::int32_t n : numbers) {
    if (std::isfinite(found.thickness(n)) && std::abs(interpolant.u[n] - 0.5) < 0.15)
      sorted.push_back(n);
  }
  std::string lines, ends[2];
  for (const std::int32_t n : spread(tracer.annulus(), sorted, spacing)) {
    const std::vector<Point> path = pathThrough(tracer, found, n);
    for (std::size_t k = 0; k < path.size(); ++k) {
      lines += (k == 0 ? "M" : "L") + planar::svg::pair(plane.at(path[k])) + " ";
    }
    for (int side = 0; side < 2; ++side) {
      const Point2 p = plane.at(side == 0 ? path.front() : path.back());
      ends[side] += "<circle cx=\"" + format("%.2f", p.x()) + "\" cy=\"" + format("%.2f", p.y()) +
                    "\" r=\"2.4\" fill=\"" + (side == 0 ? kInnerStyle : kOuterStyle) + "\"/>\n";
    }
  }
  page += std::string("<path fill=\"none\" stroke=\"") + kPathStyle +
          "\" stroke-width=\"1.4\" d=\"" + lines + "\"/>\n" + ends[0] + ends[1];
}

/// Edges of the grid's cells whose ends lie within half a slice.
void drawGrid(std::string& page, const Plane& plane, const AnatomicalGrid& grid, int slice) {
  // VTK's order: the corners of a face, then those of the one above.
  static constexpr std::array<std::array<int, 2>, 12> kEdges = {{{0, 1},
                                                                 {1, 2},
                                                                 {2, 3},
                                                                 {3, 0},
                                                                 {4, 5},
                                                                 {5, 6},
                                                                 {6, 7},
                                                                 {7, 4},
                                                                 {0, 4},
                                                                 {1, 5},
                                                                 {2, 6},
                                                                 {3, 7}}};
  const int edges = grid.cells.cols() == 8 ? 12 : 4;
  std::set<std::pair<std::int32_t, std::int32_t>> drawn;
  std::string lines;
  const auto near = [&](std::int32_t p) {
    return std::abs(plane.grid.toIndex(grid.points.row(p).transpose())[2] - slice) <= 0.5;
  };
  for (Eigen::Index c = 0; c < grid.cells.rows(); ++c) {
    for (int e = 0; e < edges; ++e) {
      const auto [a, b] = std::minmax(grid.cells(c, kEdges[e][0]), grid.cells(c, kEdges[e][1]));
      if (!near(a) || !near(b) || !drawn.emplace(a, b).second) continue;
      lines += "M" + planar::svg::pair(plane.at(grid.points.row(a).transpose())) + " L" +
               planar::svg::pair(plane.at(grid.points.row(b).transpose())) + " ";
    }
  }
  page += "<path fill=\"none\" stroke=\"#333\" stroke-width=\"0.5\" d=\"" + lines + "\"/>\n";
}

void drawLegend(std::string& page, double y, double scale) {
  double x = kMargin;
  page += text(x, y + 5, "u = 0");
  x += 46;
  for (int b = 0; b < kBands; ++b) {
    page += "<rect x=\"" + format("%.1f", x + 12 * b) + "\" y=\"" + format("%.1f", y - 7) +
            "\" width=\"12\" height=\"14\" fill=\"" + bandColour((b + 0.5) / kBands) + "\"/>\n";
  }
  x += 12 * kBands + 8;
  page += text(x, y + 5, "1");
  x += 34;
  for (const auto& [colour, words] :
       {std::pair{kInnerStyle, "inner boundary"}, {kOuterStyle, "outer boundary"}}) {
    page += "<circle cx=\"" + format("%.1f", x) + "\" cy=\"" + format("%.1f", y) +
            "\" r=\"3\" fill=\"" + colour + "\"/>\n" + text(x + 9, y + 5, words);
    x += 130;
  }
  page += planar::svg::scaleBar(x, y, scale, "mm").drawn;
}

}  // namespace

int fullestSlice(const Annulus& annulus) {
  std::vector<int> counts(static_cast<std::size_t>(annulus.grid.size[2]), 0);
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(annulus.count()); ++n) {
    ++counts[static_cast<std::size_t>(std::lround(annulus.index(n)[2]))];
  }
  return static_cast<int>(std::max_element(counts.begin(), counts.end()) - counts.begin());
}

std::string drawField(const Annulus& annulus, const Interpolant& interpolant,
                      const Correspondence& correspondence, int slice, const AnatomicalGrid* grid) {
  const std::vector<std::int32_t> numbers = tissueOf(annulus, slice);
  if (numbers.empty()) {
    throw InvalidInput("figure: no tissue in slice " + std::to_string(slice) +
                       ", counted from 0 to " + std::to_string(annulus.grid.size[2] - 1));
  }
  const Eigen::Vector2d h = annulus.grid.spacing.head<2>();
  Eigen::Vector2d low = Eigen::Vector2d::Constant(kInfinity), high = -low;
  for (const std::int32_t n : numbers) {
    const Eigen::Vector2d at = annulus.index(n).head<2>().cwiseProduct(h);
    low = low.cwiseMin(at - 1.5 * h);
    high = high.cwiseMax(at + 1.5 * h);
  }
  const double longest = (high - low).maxCoeff();
  Plane plane{annulus.grid, kPanel / longest, low};
  const Eigen::Vector2d size = plane.scale * (high - low);
  const int panels = grid ? 4 : 3;
  const int columns = grid ? 2 : 3;
  const int rows = (panels + columns - 1) / columns;
  const double cell = std::max(size.x(), 200.0) + kMargin;
  const double row = kTitle + size.y() + kMargin;
  const double width = std::max(kMargin + columns * cell, 700.0);
  std::string page = planar::svg::pageBegin(width, rows * row + kLegend);
  const TrajectoryTracer tracer(annulus, interpolant);
  static constexpr std::array<const char*, 4> kTitles = {"harmonic interpolant u", "tangent field",
                                                         "trajectories", "grid"};
  for (int p = 0; p < panels; ++p) {
    plane.left = kMargin + p % columns * cell;
    plane.top = p / columns * row + kTitle;
    page += planar::svg::panelTitle(plane.left, plane.top - 10, p, kTitles[p]);
    drawVoxels(page, plane, annulus, numbers, p == 0 ? &interpolant.u : nullptr);
    if (p == 1) drawArrows(page, plane, tracer, numbers, longest / kArrowsAcross);
    if (p == 2)
      drawPaths(page, plane, tracer, interpolant, correspondence, numbers, longest / kPathsAcross);
    if (p == 3) drawGrid(page, plane, *grid, slice);
    drawBoundary(page, plane, annulus, numbers, correspondence.innerDistance,
                 correspondence.innerPoint, kInnerStyle);
    drawBoundary(page, plane, annulus, numbers, correspondence.outerDistance,
                 correspondence.outerPoint, kOuterStyle);
  }
  drawLegend(page, rows * row + kLegend / 2, plane.scale);
  return page + "</svg>\n";
}

}  // namespace explica::correspondence
