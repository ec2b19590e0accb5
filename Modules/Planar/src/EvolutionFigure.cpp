// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/EvolutionFigure.h"

#include "Explica/Core/Errors.h"
#include "Explica/Planar/PolygonVisibility.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace explica::planar {
namespace {

constexpr double kPageWidth = 1180;  // SVG units
constexpr double kMargin = 18;
constexpr double kTitleHeight = 46;
constexpr double kArrowRoom = 64;  // on the viewpoint's side
constexpr int kMostColumns = 3;

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

std::string pair(double x, double y) {
  return format("%.2f", x) + "," + format("%.2f", y);
}

/// Blue where an edge faces the viewpoint, grey across, orange where it faces away.
std::string fluxColour(double flux) {
  const double t = std::clamp(flux, -1.0, 1.0);
  const double strength = std::abs(t);
  const std::array<double, 3> neutral = {150, 150, 150};
  const std::array<double, 3> towards = {20, 90, 180};
  const std::array<double, 3> away = {214, 84, 10};
  const auto& end = t >= 0 ? towards : away;
  char text[16];
  std::snprintf(text, sizeof text, "#%02x%02x%02x",
                static_cast<int>(neutral[0] + strength * (end[0] - neutral[0])),
                static_cast<int>(neutral[1] + strength * (end[1] - neutral[1])),
                static_cast<int>(neutral[2] + strength * (end[2] - neutral[2])));
  return text;
}

/// From the plane to one panel, y downward.
struct Panel {
  double left = 0;
  double top = 0;
  double scale = 1;
  Point2 low{0, 0};
  Point2 high{0, 0};
  [[nodiscard]] Point2 place(const Point2& p) const {
    return {left + scale * (p.x() - low.x()), top + scale * (high.y() - p.y())};
  }
};

void drawArrow(std::string& svg, const Panel& panel, const Point2& target,
               const Point2& viewpoint) {
  // Outside the panel's box, pointing along the rays that reach its middle.
  const Point2 direction = (target - viewpoint).normalized();
  const Point2 half = (panel.high - panel.low) / 2;
  const double reach = std::min(half.x() / std::max(1e-12, std::abs(direction.x())),
                                half.y() / std::max(1e-12, std::abs(direction.y())));
  const Point2 middle = (panel.high + panel.low) / 2;
  const Point2 tip = panel.place(middle - reach * direction);
  const Point2 along(direction.x(), -direction.y());
  const Point2 across(-along.y(), along.x());
  const Point2 end = tip - 8 * along;
  const Point2 start = end - 38 * along;
  const Point2 neck = end - 11 * along;
  svg += "<path d=\"M" + pair(start.x(), start.y()) + " L" + pair(neck.x(), neck.y()) +
         "\" stroke=\"#c08a00\" stroke-width=\"3\"/>\n";
  svg += "<polygon fill=\"#c08a00\" points=\"" + pair(end.x(), end.y()) + " " +
         pair(neck.x() + 6 * across.x(), neck.y() + 6 * across.y()) + " " +
         pair(neck.x() - 6 * across.x(), neck.y() - 6 * across.y()) + "\"/>\n";
}

void drawStage(std::string& svg, const Panel& panel, bool closed, const Point2& viewpoint,
               const EvolutionStage& stage) {
  const Curve curve{stage.positions, closed};
  const Region& region = stage.region;
  const PolygonVisibility visibility = polygonVisibility(curve, region, viewpoint);
  std::string points;
  for (int v = 0; v < curve.vertexCount(); ++v) {
    const Point2 p = panel.place(curve.point(v));
    points += pair(p.x(), p.y()) + " ";
  }
  svg +=
      curve.closed ? "<polygon fill=\"#f3e3dc\" fill-rule=\"evenodd\"" : "<polyline fill=\"none\"";
  svg += " stroke=\"#8a7f7a\" stroke-width=\"1\" points=\"" + points + "\"/>\n";
  const double width =
      std::clamp(0.12 * panel.scale * visibility.length / region.edgeCount, 1.4, 3.2);
  for (int k = 0; k < region.edgeCount; ++k) {
    const int e = (region.firstEdge + k) % curve.edgeCount();
    const Point2 a = panel.place(curve.point(e));
    const Point2 b = panel.place(curve.point(curve.next(e)));
    svg += "<path d=\"M" + pair(a.x(), a.y()) + " L" + pair(b.x(), b.y()) + "\" stroke=\"" +
           fluxColour(visibility.edgeFlux[k]) + "\" stroke-width=\"" + format("%.2f", width) +
           "\" stroke-linecap=\"round\"/>\n";
  }
  for (int v : verticesOf(curve, region)) {
    const Point2 p = panel.place(curve.point(v));
    svg += "<circle cx=\"" + format("%.2f", p.x()) + "\" cy=\"" + format("%.2f", p.y()) +
           "\" r=\"" + format("%.2f", 0.75 * width) + "\" fill=\"#222\"/>\n";
  }
}

}  // namespace

std::string drawEvolution(bool closed, const Point2& viewpoint,
                          const std::vector<EvolutionStage>& stages) {
  if (stages.empty()) throw InvalidInput("figure: no stage to draw");
  Point2 low = stages.front().positions.colwise().minCoeff().transpose();
  Point2 high = stages.front().positions.colwise().maxCoeff().transpose();
  for (const EvolutionStage& stage : stages) {
    low = low.cwiseMin(stage.positions.colwise().minCoeff().transpose());
    high = high.cwiseMax(stage.positions.colwise().maxCoeff().transpose());
  }
  const Point2 extent = (high - low).cwiseMax(1e-9);
  // As many columns as give the largest drawing on a page of modest height.
  const int count = static_cast<int>(stages.size());
  const int columns =
      extent.x() > 2.5 * extent.y() ? std::min(count, 2) : std::min(count, kMostColumns);
  const int rows = (count + columns - 1) / columns;
  const double cell = (kPageWidth - kMargin) / columns - kMargin;
  const double scale = std::min(cell / extent.x(), 420 / extent.y());
  const double drawn = scale * extent.y();
  const bool fromAbove = viewpoint.y() > high.y();
  const bool fromBelow = viewpoint.y() < low.y();
  const double roomAbove = fromAbove ? kArrowRoom : kMargin;
  const double roomBelow = fromBelow ? kArrowRoom : kMargin;
  const double rowHeight = kTitleHeight + roomAbove + drawn + roomBelow + kMargin;
  const double pageHeight = rows * rowHeight + kMargin;

  std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" +
                    format("%.0f", kPageWidth) + "\" height=\"" + format("%.0f", pageHeight) +
                    "\" viewBox=\"0 0 " + format("%.0f", kPageWidth) + " " +
                    format("%.0f", pageHeight) +
                    "\" font-family=\"sans-serif\" font-size=\"14\">\n"
                    "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  for (int s = 0; s < count; ++s) {
    Panel panel;
    panel.left = kMargin + (s % columns) * (cell + kMargin) + (cell - scale * extent.x()) / 2;
    panel.top = kMargin + (s / columns) * rowHeight + kTitleHeight + roomAbove;
    panel.scale = scale;
    panel.low = low;
    panel.high = high;
    const EvolutionStage& stage = stages[s];
    const double textX = kMargin + (s % columns) * (cell + kMargin);
    const double textY = kMargin + (s / columns) * rowHeight + 16;
    svg += "<text x=\"" + format("%.1f", textX) + "\" y=\"" + format("%.1f", textY) +
           "\" font-weight=\"bold\">" + stage.title + "</text>\n";
    svg += "<text x=\"" + format("%.1f", textX) + "\" y=\"" + format("%.1f", textY + 19) +
           "\" fill=\"#444\">visibility " + format("%.3f", stage.visibility) + ", flux variance " +
           format("%.3f", stage.variance) + ", length " + format("%.2f", stage.length) +
           "</text>\n";
    drawArrow(svg, panel, (low + high) / 2, viewpoint);
    drawStage(svg, panel, closed, viewpoint, stage);
  }
  svg += "</svg>\n";
  return svg;
}

std::vector<std::size_t> evenStages(const std::vector<double>& values, std::size_t count) {
  std::vector<std::size_t> picked;
  if (values.empty() || count == 0) return picked;
  if (values.size() <= count) {
    for (std::size_t i = 0; i < values.size(); ++i) picked.push_back(i);
    return picked;
  }
  picked.push_back(0);
  for (std::size_t k = 1; k + 1 < count; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(count - 1);
    const double wanted = values.front() + share * (values.back() - values.front());
    // The first later entry that reaches the value, leaving room for those still to come.
    std::size_t i = picked.back() + 1;
    const std::size_t latest = values.size() - (count - k);
    const bool rising = values.back() >= values.front();
    while (i < latest && (rising ? values[i] < wanted : values[i] > wanted)) ++i;
    picked.push_back(i);
  }
  if (count > 1) picked.push_back(values.size() - 1);
  return picked;
}

}  // namespace explica::planar
