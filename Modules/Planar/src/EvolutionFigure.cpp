// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/EvolutionFigure.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Planar/PolygonVisibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace explica::planar {
namespace {

constexpr double kMargin = 18;        // of pages, pixels
constexpr int kMostColumns = 3;       // pictures beside each other
constexpr double kLongestBar = 100;   // SVG units
constexpr double kLetterWidth = 7.5;  // of 14-unit text, about
constexpr double kPageWidth = 1180;   // SVG units
constexpr double kTitleHeight = 46;   // pixels
constexpr double kArrowRoom = 64;     // on the viewpoint's side
constexpr double kLegendHeight = 44;  // pixels
constexpr double kBarLength = 100;    // of the legend's colours

/// The largest of 1, 2, 5 times a power of ten that is not above a length.
double roundLength(double most) {
  const double decade = std::pow(10, std::floor(std::log10(most)));
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= most) return step * decade;
  }
  return decade;
}

std::string pair(const Point2& page) {
  return printed("%.2f", page.x()) + "," + printed("%.2f", page.y());
}

std::string text(double x, double y, const std::string& words, const std::string& style = "") {
  return "<text x=\"" + printed("%.1f", x) + "\" y=\"" + printed("%.1f", y) + "\" " + style + ">" +
         words + "</text>\n";
}

std::string pageBegin(double width, double height) {
  const std::string w = printed("%.0f", width);
  const std::string h = printed("%.0f", height);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + w + "\" height=\"" + h +
         "\" viewBox=\"0 0 " + w + " " + h +
         "\" font-family=\"sans-serif\" font-size=\"14\">\n"
         "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
}

std::string panelTitle(double x, double y, int panel, const std::string& title) {
  return text(x, y, std::string("(") + static_cast<char>('a' + panel % 26) + ") " + title,
              "font-weight=\"bold\"");
}

/// A bar of a round length and what it stands for; its width with its words, about.
struct ScaleBar {
  std::string drawn;
  double width = 0;
};
ScaleBar scaleBar(double x, double y, double scale, const std::string& unit) {
  const double length = roundLength(kLongestBar / scale);
  const std::string words = printed("%g", length) + " " + unit;
  return {"<path d=\"M" + pair({x, y}) + " h" + printed("%.2f", scale * length) +
              "\" stroke=\"#222\" stroke-width=\"2.5\"/>\n" +
              text(x + scale * length + 8, y + 5, words),
          scale * length + 8 + kLetterWidth * static_cast<double>(words.size())};
}

/// Blue where an edge faces the viewpoint, grey across, orange where it faces away.
std::string fluxColour(double flux) {
  const double t = std::clamp(flux, -1.0, 1.0);
  const double strength = std::abs(t);
  const std::array<double, 3> neutral = {150, 150, 150};
  const std::array<double, 3> towards = {20, 90, 180};
  const std::array<double, 3> away = {214, 84, 10};
  const auto& end = t >= 0 ? towards : away;
  return printed("#%02x%02x%02x", static_cast<int>(neutral[0] + strength * (end[0] - neutral[0])),
                 static_cast<int>(neutral[1] + strength * (end[1] - neutral[1])),
                 static_cast<int>(neutral[2] + strength * (end[2] - neutral[2])));
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

// The viewpoint and the ends of the region.
constexpr const char* kRing = " fill=\"none\" stroke=\"#c2185b\" stroke-width=\"1.8\"";

/// An arrow of 46 units from a point along a unit direction of the page.
std::string arrow(const Point2& start, const Point2& along) {
  const Point2 across(-along.y(), along.x());
  const Point2 end = start + 46 * along;
  const Point2 neck = end - 11 * along;
  return "<path d=\"M" + pair(start) + " L" + pair(neck) +
         "\" stroke=\"#c08a00\" stroke-width=\"3\"/>\n<polygon fill=\"#c08a00\" points=\"" +
         pair(end) + " " + pair(neck + 6 * across) + " " + pair(neck - 6 * across) + "\"/>\n";
}

/// Outside the panel's box, pointing along the rays that reach its middle.
void drawArrow(std::string& page, const Panel& panel, const Point2& viewpoint) {
  const Point2 middle = (panel.high + panel.low) / 2;
  const Point2 direction = (middle - viewpoint).normalized();
  const Point2 half = (panel.high - panel.low) / 2;
  const double reach = std::min(half.x() / std::max(1e-12, std::abs(direction.x())),
                                half.y() / std::max(1e-12, std::abs(direction.y())));
  const Point2 along(direction.x(), -direction.y());
  page += arrow(panel.place(middle - reach * direction) - 54 * along, along);
}

/// Where two edges cross; of edges along one line the middle of their ends.
Point2 crossingOf(const Curve& curve, const std::array<int, 2>& pair) {
  const Point2 a = curve.point(pair[0]);
  const Point2 t = curve.point(curve.next(pair[0])) - a;
  const Point2 c = curve.point(pair[1]);
  const Point2 u = curve.point(curve.next(pair[1])) - c;
  const double cross = t.x() * u.y() - t.y() * u.x();
  if (cross == 0) return (2 * a + t + 2 * c + u) / 4;
  const Point2 d = c - a;
  return a + (d.x() * u.y() - d.y() * u.x()) / cross * t;
}

/// What colours, arrows and rings mean, and a scale bar.
void drawLegend(std::string& page, double top, double scale, bool anyCrossing) {
  const double y = top + 20;
  double x = kMargin;
  page += text(x, y + 5, "flux &#8722;1");
  x += 62;
  page += "<linearGradient id=\"flux\">";
  for (const double flux : {-1.0, 0.0, 1.0}) {
    page += "<stop offset=\"" + printed("%g", (flux + 1) / 2) + "\" stop-color=\"" +
            fluxColour(flux) + "\"/>";
  }
  page += "</linearGradient>\n<rect x=\"" + printed("%.1f", x) + "\" y=\"" +
          printed("%.1f", y - 5) + "\" width=\"" + printed("%.0f", kBarLength) +
          "\" height=\"10\" fill=\"url(#flux)\"/>\n";
  x += kBarLength + 6;
  page += text(x, y + 5, "1");
  x += 46;
  page += arrow({x, y}, {1, 0});
  page += text(x + 58, y + 5, "direction of view");
  x += 210;
  const ScaleBar bar = scaleBar(x, y, scale, "units of length");
  page += bar.drawn;
  if (!anyCrossing) return;
  x += bar.width + 30;
  page += "<circle cx=\"" + printed("%.1f", x) + "\" cy=\"" + printed("%.1f", y) + "\" r=\"7\"" +
          kRing + "/>\n";
  page += text(x + 14, y + 5, "edges cross");
}

/// Of vertices in order, the first, the last, and those between that a page tells apart.
std::vector<int> drawnOf(const Curve& curve, const std::vector<int>& vertices, const Panel& panel) {
  constexpr double kApart = 0.2;  // SVG units
  std::vector<int> drawn;
  for (const int& v : vertices) {
    const Point2 p = panel.place(curve.point(v));
    if (drawn.empty() || &v == &vertices.back() ||
        (p - panel.place(curve.point(drawn.back()))).norm() >= kApart) {
      drawn.push_back(v);
    }
  }
  return drawn;
}

void drawStage(std::string& page, const Panel& panel, bool closed, const Viewpoints& view,
               const EvolutionStage& stage) {
  const Curve curve{stage.positions, closed};
  const Region& region = stage.region;
  const PolygonVisibility visibility = polygonVisibility(curve, region, view);
  std::vector<int> all(static_cast<std::size_t>(curve.vertexCount()));
  std::iota(all.begin(), all.end(), 0);
  std::string points;
  for (const int v : drawnOf(curve, all, panel)) points += pair(panel.place(curve.point(v))) + " ";
  page +=
      curve.closed ? "<polygon fill=\"#f3e3dc\" fill-rule=\"evenodd\"" : "<polyline fill=\"none\"";
  page += " stroke=\"#8a7f7a\" stroke-width=\"1\" points=\"" + points + "\"/>\n";
  const double width =
      std::clamp(0.12 * panel.scale * visibility.length / region.edgeCount, 1.4, 3.2);
  std::vector<int> around = verticesOf(curve, region);
  if (region.edgeCount == curve.vertexCount()) around.push_back(around.front());
  const std::vector<int> drawn = drawnOf(curve, around, panel);
  for (std::size_t k = 0; k + 1 < drawn.size(); ++k) {
    const int edge = (drawn[k] - region.firstEdge + curve.edgeCount()) % curve.edgeCount();
    page += "<path d=\"M" + pair(panel.place(curve.point(drawn[k]))) + " L" +
            pair(panel.place(curve.point(drawn[k + 1]))) + "\" stroke=\"" +
            fluxColour(visibility.edgeFlux[edge]) + "\" stroke-width=\"" + printed("%.2f", width) +
            "\" stroke-linecap=\"round\"/>\n";
  }
  for (const int v : drawn) {
    const Point2 p = panel.place(curve.point(v));
    page += "<circle cx=\"" + printed("%.2f", p.x()) + "\" cy=\"" + printed("%.2f", p.y()) +
            "\" r=\"" + printed("%.2f", 0.75 * width) + "\" fill=\"#222\"/>\n";
  }
  for (const auto& crossing : stage.crossings) {
    const Point2 p = panel.place(crossingOf(curve, crossing));
    page += "<circle cx=\"" + printed("%.2f", p.x()) + "\" cy=\"" + printed("%.2f", p.y()) +
            "\" r=\"7\"" + kRing + "/>\n";
  }
}

}  // namespace

std::string drawEvolution(bool closed, const Viewpoints& view,
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
  bool fromAbove = false;
  bool fromBelow = false;
  for (const Point2& point : view.points) {
    fromAbove = fromAbove || point.y() > high.y();
    fromBelow = fromBelow || point.y() < low.y();
  }
  const double roomAbove = fromAbove ? kArrowRoom : kMargin;
  const double roomBelow = fromBelow ? kArrowRoom : kMargin;
  const double rowHeight = kTitleHeight + roomAbove + drawn + roomBelow + kMargin;
  const double pageHeight = rows * rowHeight + kLegendHeight;

  std::string page = pageBegin(kPageWidth, pageHeight);
  bool anyCrossing = false;
  for (int s = 0; s < count; ++s) {
    const int row = s / columns;
    Panel panel;
    panel.left = kMargin + (s % columns) * (cell + kMargin) + (cell - scale * extent.x()) / 2;
    panel.top = kMargin + row * rowHeight + kTitleHeight + roomAbove;
    panel.scale = scale;
    panel.low = low;
    panel.high = high;
    const EvolutionStage& stage = stages[s];
    const double textX = kMargin + (s % columns) * (cell + kMargin);
    const double textY = kMargin + row * rowHeight + 16;
    // Of several viewpoints the first and the last.
    drawArrow(page, panel, view.points.front());
    if (view.points.size() > 1) drawArrow(page, panel, view.points.back());
    drawStage(page, panel, closed, view, stage);
    const std::size_t crossings = stage.crossings.size();
    anyCrossing = anyCrossing || crossings > 0;
    const std::string numbers = "visibility " + printed("%.3f", stage.visibility) +
                                ", flux variance " + printed("%.3f", stage.variance) + ", length " +
                                printed("%.2f", stage.length);
    const std::string crossed =
        crossings > 0 ? ", crossings " + std::to_string(crossings) : std::string();
    page += panelTitle(textX, textY, s, stage.title + crossed);
    page += text(textX, textY + 19, numbers, "fill=\"#444\"");
  }
  drawLegend(page, rows * rowHeight, scale, anyCrossing);
  page += "</svg>\n";
  return page;
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
