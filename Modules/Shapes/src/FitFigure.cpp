// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Shapes/FitFigure.h"

#include "Explica/Core/Errors.h"
#include "Explica/Planar/SvgParts.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace explica::shapes {
namespace {

using planar::svg::format;
using planar::svg::kMargin;
using planar::svg::kMostColumns;
using planar::svg::text;

constexpr double kPanel = 340;        // SVG units
constexpr double kTitleHeight = 64;   // pixels
constexpr double kLegendHeight = 64;  // pixels
// The contour that is fitted.
constexpr const char* kTargetStyle =
    "stroke=\"#d6540a\" stroke-width=\"4\" stroke-opacity=\"0.55\"";
constexpr const char* kShapeStyle = "stroke=\"#145ab4\" stroke-width=\"1.8\"";  // the fit
// The annulus' two circles.
constexpr const char* kRimStyle = "stroke=\"#9a9a9a\" stroke-dasharray=\"4 3\"";

/// From the plane to one panel, y downward; the outer boundary just fits.
struct Panel {
  double left = 0;
  double top = 0;
  double scale = 1;
  Point centre;

  [[nodiscard]] std::string place(const planar::Point2& p) const {
    return format("%.2f", left + kPanel / 2 + scale * (p.x() - centre.x())) + "," +
           format("%.2f", top + kPanel / 2 - scale * (p.y() - centre.y()));
  }
};

/// Where a sphere about the centre meets the plane at z, or a circle.
void drawCircle(std::string& page, const Panel& panel, const HarmonicAnnulus& annulus,
                double radius, double z, const char* fill) {
  const double height = annulus.dimension == 2 ? 0 : z - annulus.centre.z();
  if (std::abs(height) >= radius) return;
  page += "<circle cx=\"" + format("%.2f", panel.left + kPanel / 2) + "\" cy=\"" +
          format("%.2f", panel.top + kPanel / 2) + "\" r=\"" +
          format("%.2f", panel.scale * std::sqrt(radius * radius - height * height)) +
          "\" fill=\"" + fill + "\" " + kRimStyle + "/>\n";
}

void drawPolygon(std::string& page, const Panel& panel, const planar::Curve& curve,
                 const char* fill) {
  page += "<polygon points=\"";
  for (int v = 0; v < curve.vertexCount(); ++v) page += panel.place(curve.point(v)) + " ";
  page += std::string("\" fill=\"") + fill + "\" " + kRimStyle + "/>\n";
}

void drawAnnulus(std::string& page, const Panel& panel, const HarmonicAnnulus& annulus, double z) {
  constexpr const char* kTissue = "#f1f3f5";
  constexpr const char* kPaper = "#ffffff";
  if (annulus.map) {
    drawPolygon(page, panel, annulus.map->outer(), kTissue);
    drawPolygon(page, panel, annulus.map->inner(), kPaper);
  } else {
    drawCircle(page, panel, annulus, annulus.outerRadius, z, kTissue);
    drawCircle(page, panel, annulus, annulus.innerRadius, z, kPaper);
  }
}

/// What the lines are, and a scale bar; in narrow figures on as many lines as it takes.
void drawLegend(std::string& page, double top, double width, double scale, bool target = true) {
  double x = kMargin;
  double y = top + 20;
  const auto room = [&](double needed) {
    if (x > kMargin && x + needed > width) {
      x = kMargin;
      y += 20;
    }
  };
  const auto entry = [&](const char* style, const char* words, double length) {
    room(length);
    page += std::string("<path ") + style + " d=\"M" + planar::svg::pair({x, y}) + " h30\"/>\n";
    page += text(x + 38, y + 5, words);
    x += length;
  };
  if (target) entry(kTargetStyle, "target", 110);
  entry(kShapeStyle, "shape", 110);
  entry(kRimStyle, "annulus", 125);
  room(170);
  page += planar::svg::scaleBar(x, y, scale, "mm").drawn;
}

void drawOutline(std::string& page, const Panel& panel, const Outline& outline, const char* style) {
  page += "<path fill=\"none\" stroke-linecap=\"round\" ";
  page += style;
  page += " d=\"";
  for (const auto& segment : outline) {
    page += "M" + panel.place(segment[0]) + " L" + panel.place(segment[1]) + " ";
  }
  page += "\"/>\n";
}

}  // namespace

Outline outlineOf(const planar::Curve& curve) {
  Outline outline;
  for (int e = 0; e < curve.edgeCount(); ++e) {
    outline.push_back({curve.point(e), curve.point(curve.next(e))});
  }
  return outline;
}

Outline sectionOf(const TriangleMesh& mesh, double z) {
  Outline outline;
  for (Eigen::Index f = 0; f < mesh.faceCount(); ++f) {
    std::vector<planar::Point2> crossings;
    for (int k = 0; k < 3; ++k) {
      const Point a = mesh.corner(f, k);
      const Point b = mesh.corner(f, (k + 1) % 3);
      if ((a.z() < z) == (b.z() < z)) continue;
      const double share = (z - a.z()) / (b.z() - a.z());
      crossings.emplace_back((a + share * (b - a)).head<2>());
    }
    if (crossings.size() == 2) outline.push_back({crossings[0], crossings[1]});
  }
  return outline;
}

std::string drawFit(const HarmonicAnnulus& annulus, double z, const Outline& target,
                    const std::vector<FitStage>& stages) {
  if (stages.empty()) throw InvalidInput("figure: no stage to draw");
  requireUsable(annulus);
  const AnnulusBox box = boxOf(annulus);
  const int count = static_cast<int>(stages.size());
  const int columns = std::min(count, kMostColumns);
  const int rows = (count + columns - 1) / columns;
  const double rowHeight = kTitleHeight + kPanel + kMargin;
  const double width = columns * (kPanel + kMargin) + kMargin;
  const double height = rows * rowHeight + kLegendHeight;
  std::string page = planar::svg::pageBegin(width, height);
  for (int s = 0; s < count; ++s) {
    const FitStage& stage = stages[static_cast<std::size_t>(s)];
    Panel panel;
    const int column = s % columns, row = s / columns;
    panel.left = kMargin + column * (kPanel + kMargin);
    panel.top = kMargin + row * rowHeight + kTitleHeight;
    panel.scale = (kPanel / 2 - 2) / box.halfSide;
    panel.centre = box.centre;
    const double top = panel.top - kTitleHeight;
    page += planar::svg::panelTitle(panel.left, top + 16, s, stage.title);
    const bool large = stage.symmetricDifference >= 1000;
    page +=
        text(panel.left, top + 35,
             "symmetric difference " + format(large ? "%.0f" : "%.3g", stage.symmetricDifference) +
                 (annulus.dimension == 2 ? " mm²" : " mm³"),
             "fill=\"#444\"");
    page += text(panel.left, top + 53,
                 "largest distance " + format("%.2f", stage.distanceMax) + " mm", "fill=\"#444\"");
    drawAnnulus(page, panel, annulus, z);
    drawOutline(page, panel, target, kTargetStyle);
    drawOutline(page, panel, stage.outline, kShapeStyle);
  }
  drawLegend(page, rows * rowHeight, width, (kPanel / 2 - 2) / box.halfSide);
  page += "</svg>\n";
  return page;
}

std::string drawSeries(const HarmonicAnnulus& annulus, double z,
                       const std::vector<SeriesPanel>& panels) {
  if (panels.empty()) throw InvalidInput("figure: no shape to draw");
  requireUsable(annulus);
  const AnnulusBox box = boxOf(annulus);
  const int count = static_cast<int>(panels.size());
  const int columns = std::min(count, kMostColumns);
  const int rows = (count + columns - 1) / columns;
  constexpr double kTitle = 28;  // pixels
  const double rowHeight = kTitle + kPanel + kMargin;
  const double width = columns * (kPanel + kMargin) + kMargin;
  const double scale = (kPanel / 2 - 2) / box.halfSide;
  std::string page = planar::svg::pageBegin(width, rows * rowHeight + kLegendHeight);
  for (int p = 0; p < count; ++p) {
    Panel panel;
    panel.left = kMargin + p % columns * (kPanel + kMargin);
    panel.top = kMargin + p / columns * rowHeight + kTitle;
    panel.scale = scale;
    panel.centre = box.centre;
    const SeriesPanel& shape = panels[static_cast<std::size_t>(p)];
    page += planar::svg::panelTitle(panel.left, panel.top - 10, p, shape.title);
    drawAnnulus(page, panel, annulus, z);
    drawOutline(page, panel, shape.outline, kShapeStyle);
  }
  drawLegend(page, rows * rowHeight, width, scale, false);
  page += "</svg>\n";
  return page;
}

}  // namespace explica::shapes
