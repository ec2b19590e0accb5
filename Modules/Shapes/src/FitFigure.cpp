// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Shapes/FitFigure.h"

#include "Explica/Core/Errors.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace explica::shapes {
namespace {

constexpr double kPanel = 340;  // SVG units
constexpr double kMargin = 18;
constexpr double kTitleHeight = 64;
constexpr int kMostColumns = 3;

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

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

constexpr const char* kRim = "\" stroke=\"#9a9a9a\" stroke-dasharray=\"4 3\"/>\n";

/// Where a sphere about the centre meets the plane at z, or a circle.
void drawCircle(std::string& svg, const Panel& panel, const HarmonicAnnulus& annulus, double radius,
                double z, const char* fill) {
  const double height = annulus.dimension == 2 ? 0 : z - annulus.centre.z();
  if (std::abs(height) >= radius) return;
  svg += "<circle cx=\"" + format("%.2f", panel.left + kPanel / 2) + "\" cy=\"" +
         format("%.2f", panel.top + kPanel / 2) + "\" r=\"" +
         format("%.2f", panel.scale * std::sqrt(radius * radius - height * height)) + "\" fill=\"" +
         fill + kRim;
}

void drawPolygon(std::string& svg, const Panel& panel, const planar::Curve& curve,
                 const char* fill) {
  svg += "<polygon points=\"";
  for (int v = 0; v < curve.vertexCount(); ++v) svg += panel.place(curve.point(v)) + " ";
  svg += std::string("\" fill=\"") + fill + kRim;
}

void drawAnnulus(std::string& svg, const Panel& panel, const HarmonicAnnulus& annulus, double z) {
  constexpr const char* kTissue = "#f1f3f5";
  constexpr const char* kPaper = "#ffffff";
  if (annulus.map) {
    drawPolygon(svg, panel, annulus.map->outer(), kTissue);
    drawPolygon(svg, panel, annulus.map->inner(), kPaper);
  } else {
    drawCircle(svg, panel, annulus, annulus.outerRadius, z, kTissue);
    drawCircle(svg, panel, annulus, annulus.innerRadius, z, kPaper);
  }
}

void drawOutline(std::string& svg, const Panel& panel, const Outline& outline, const char* style) {
  svg += "<path fill=\"none\" stroke-linecap=\"round\" ";
  svg += style;
  svg += " d=\"";
  for (const auto& segment : outline) {
    svg += "M" + panel.place(segment[0]) + " L" + panel.place(segment[1]) + " ";
  }
  svg += "\"/>\n";
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
  const double height = rows * rowHeight + kMargin;
  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + format("%.0f", width) +
                    "\" height=\"" + format("%.0f", height) + "\" viewBox=\"0 0 " +
                    format("%.0f", width) + " " + format("%.0f", height) +
                    "\" font-family=\"sans-serif\" font-size=\"14\">\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  for (int s = 0; s < count; ++s) {
    const FitStage& stage = stages[static_cast<std::size_t>(s)];
    Panel panel;
    panel.left = kMargin + (s % columns) * (kPanel + kMargin);
    panel.top = kMargin + (s / columns) * rowHeight + kTitleHeight;
    panel.scale = (kPanel / 2 - 2) / box.halfSide;
    panel.centre = box.centre;
    svg += "<text x=\"" + format("%.1f", panel.left) + "\" y=\"" +
           format("%.1f", panel.top - kTitleHeight + 16) + "\" font-weight=\"bold\">" +
           stage.title + "</text>\n";
    svg += "<text x=\"" + format("%.1f", panel.left) + "\" y=\"" +
           format("%.1f", panel.top - kTitleHeight + 35) +
           "\" fill=\"#444\">symmetric difference " + format("%.4g", stage.symmetricDifference) +
           (annulus.dimension == 2 ? " mm²" : " mm³") + "</text>\n";
    svg += "<text x=\"" + format("%.1f", panel.left) + "\" y=\"" +
           format("%.1f", panel.top - kTitleHeight + 53) + "\" fill=\"#444\">largest distance " +
           format("%.2f", stage.distanceMax) + " mm</text>\n";
    drawAnnulus(svg, panel, annulus, z);
    drawOutline(svg, panel, target,
                "stroke=\"#d6540a\" stroke-width=\"4\" stroke-opacity=\"0.55\"");
    drawOutline(svg, panel, stage.outline, "stroke=\"#145ab4\" stroke-width=\"1.8\"");
  }
  svg += "</svg>\n";
  return svg;
}

}  // namespace explica::shapes
