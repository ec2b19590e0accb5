// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Explica/Planar/EvolutionFigure.h"

#include "Explica/Core/Errors.h"
#include "Explica/Core/Text.h"
#include "Explica/Planar/PolygonVisibility.h"
#include "Explica/Report/FlatFigure.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace explica::planar {
namespace {

using report::Canvas;
using report::Colour;
using report::kInk;
using report::TextAnchor;

constexpr double kPageWidth = 1180, kMargin = 18, kTitleHeight = 46, kLegendHeight = 44;  // pixels
constexpr double kArrowRoom = 64, kArrow = 46;      // pixels, on the viewpoint's side
constexpr double kMostHeight = 420, kRing = 7;      // of a panel, of a ring's radius; pixels
constexpr double kLetters = 10, kLongestBar = 100;  // height of capitals, of scale bars; pixels

constexpr Colour kTissueColour = {0.90F, 0.77F, 0.72F}, kOutline = {0.25F, 0.21F, 0.20F};
constexpr Colour kView = {0.53F, 0.25F, 0}, kCrossing = {0.54F, 0.01F, 0.10F};

/// Blue where an edge faces the viewpoint, grey across, orange where it faces away.
Colour fluxColour(double flux) {
  constexpr Colour kAcross = {0.31F, 0.31F, 0.31F};
  constexpr Colour kTowards = {0.01F, 0.10F, 0.46F}, kAway = {0.67F, 0.09F, 0};
  const auto strength = static_cast<float>(std::min(std::abs(flux), 1.0));
  Colour colour = flux >= 0 ? kTowards : kAway;
  for (std::size_t c = 0; c < 3; ++c) colour[c] = std::lerp(kAcross[c], colour[c], strength);
  return colour;
}

/// From the plane to one panel, y downward.
struct Panel {
  Point2 corner{0, 0};  ///< of the drawing
  double scale = 1;
  Eigen::AlignedBox2d box;
  [[nodiscard]] Point2 place(const Point2& p) const {
    return corner + scale * Point2(p.x() - box.min().x(), box.max().y() - p.y());
  }
};

void drawArrow(Canvas& page, const Point2& start, const Point2& along) {
  const Point2 across(-along.y(), along.x()), end = start + kArrow * along, neck = end - 11 * along;
  page.lines({{start, neck}}, kView, 3);
  page.fill({end, neck + 6 * across, neck - 6 * across}, kView);
}

/// Outside the panel's box, pointing along the rays that reach its middle.
void drawView(Canvas& page, const Panel& panel, const Point2& viewpoint) {
  const Point2 middle = panel.box.center(), direction = (middle - viewpoint).normalized();
  const double reach =
      (0.5 * panel.box.sizes().array() / direction.array().abs().max(1e-12)).minCoeff();
  const Point2 along(direction.x(), -direction.y());
  drawArrow(page, panel.place(middle - reach * direction) - 54 * along, along);
}

void drawRing(Canvas& page, const Point2& middle) {
  constexpr int kCorners = 24;
  std::vector<Point2> ring;
  for (int k = 0; k < kCorners; ++k) {
    const double angle = 2 * kPi * k / kCorners;
    ring.emplace_back(middle + kRing * Point2(std::cos(angle), std::sin(angle)));
  }
  page.stroke(ring, kCrossing, 1.8, true);
}

/// Where two edges cross; of edges along one line the middle of their ends.
Point2 crossingOf(const Curve& curve, const std::array<int, 2>& pair) {
  const Point2 a = curve.point(pair[0]), t = curve.point(curve.next(pair[0])) - a;
  const Point2 c = curve.point(pair[1]), u = curve.point(curve.next(pair[1])) - c;
  const double cross = t.x() * u.y() - t.y() * u.x();
  if (cross == 0) return (2 * a + t + 2 * c + u) / 4;
  const Point2 d = c - a;
  return a + (d.x() * u.y() - d.y() * u.x()) / cross * t;
}

/// What colours, arrows and rings mean, and a scale bar.
void drawLegend(Canvas& page, double y, double scale, bool anyCrossing) {
  double x = kMargin;
  const auto say = [&](const std::string& words, double room) {
    page.text({x, y + 5}, words, kLetters, kInk, TextAnchor::Left);
    x += room;
  };
  say("flux \u22121", 62);
  for (int k = 0; k < kLongestBar; ++k, ++x) {
    page.rectangle({x, y - 5}, {1.5, 10}, fluxColour(2 * k / kLongestBar - 1));
  }
  x += 6;
  say("1", 46);
  drawArrow(page, {x, y}, {1, 0});
  x += 58;
  say("direction of view", 152);
  const double length = report::roundLength(kLongestBar / scale);
  page.lines({{{x, y}, {x + scale * length, y}}}, kInk, 2.5);
  x += scale * length + 8;
  say(printed("%g units of length", length), 190);
  if (!anyCrossing) return;
  drawRing(page, {x, y});
  x += 14;
  say("edges cross", 0);
}

/// Where vertices in order are drawn: the first, the last, and those between that a page tells
/// apart.
std::vector<int> drawnOf(const Curve& curve, const std::vector<int>& vertices, const Panel& panel) {
  constexpr double kApart = 0.2;  // pixels
  std::vector<int> drawn;
  for (const int& v : vertices) {
    if (drawn.empty() || &v == &vertices.back() ||
        panel.scale * (curve.point(v) - curve.point(drawn.back())).norm() >= kApart) {
      drawn.push_back(v);
    }
  }
  return drawn;
}

void drawStage(Canvas& page, const Panel& panel, bool closed, const Viewpoints& view,
               const EvolutionStage& stage) {
  const Curve curve{stage.positions, closed};
  const Region& region = stage.region;
  const PolygonVisibility visibility = polygonVisibility(curve, region, view);
  std::vector<int> all(static_cast<std::size_t>(curve.vertexCount()));
  std::iota(all.begin(), all.end(), 0);
  std::vector<Point2> outline;
  for (const int v : drawnOf(curve, all, panel)) outline.push_back(panel.place(curve.point(v)));
  if (closed) page.fill(outline, kTissueColour);
  page.stroke(outline, kOutline, 1, closed);
  const double width =
      std::clamp(0.12 * panel.scale * visibility.length / region.edgeCount, 1.4, 3.2);
  std::vector<int> around = verticesOf(curve, region);
  if (region.edgeCount == curve.vertexCount()) around.push_back(around.front());
  const std::vector<int> drawn = drawnOf(curve, around, panel);
  std::vector<report::Segment2> dots;
  for (std::size_t k = 0; k < drawn.size(); ++k) {
    const Point2 at = panel.place(curve.point(drawn[k]));
    dots.push_back({at, at});
    if (k + 1 == drawn.size()) break;
    const int edge = (drawn[k] - region.firstEdge + curve.edgeCount()) % curve.edgeCount();
    page.lines({{at, panel.place(curve.point(drawn[k + 1]))}},
               fluxColour(visibility.edgeFlux[edge]), width);
  }
  page.lines(dots, kInk, 1.5 * width, "vertices");
  for (const auto& pair : stage.crossings) drawRing(page, panel.place(crossingOf(curve, pair)));
}

}  // namespace

std::string drawEvolution(bool closed, const Viewpoints& view,
                          const std::vector<EvolutionStage>& stages) {
  if (stages.empty()) throw InvalidInput("figure: no stage to draw");
  Panel panel;
  for (const EvolutionStage& stage : stages) {
    panel.box.extend(stage.positions.colwise().minCoeff().transpose());
    panel.box.extend(stage.positions.colwise().maxCoeff().transpose());
  }
  const Point2 extent = panel.box.sizes().cwiseMax(1e-9);
  // As many columns as give the largest drawing on a page of modest height.
  const int count = static_cast<int>(stages.size());
  const int columns = std::min(count, extent.x() > 2.5 * extent.y() ? 2 : 3);
  const int rows = (count + columns - 1) / columns;
  const double cell = (kPageWidth - kMargin) / columns - kMargin;
  panel.scale = std::min(cell / extent.x(), kMostHeight / extent.y());
  const auto isSeenFrom = [&](auto&& beyond) { return std::ranges::any_of(view.points, beyond); };
  const double above = isSeenFrom([&](const Point2& p) { return p.y() > panel.box.max().y(); })
                           ? kArrowRoom
                           : kMargin;
  const double below = isSeenFrom([&](const Point2& p) { return p.y() < panel.box.min().y(); })
                           ? kArrowRoom
                           : kMargin;
  const double rowHeight = kTitleHeight + above + panel.scale * extent.y() + below + kMargin;
  Canvas page(static_cast<int>(kPageWidth), static_cast<int>(rows * rowHeight + kLegendHeight));
  bool anyCrossing = false;
  for (int s = 0; s < count; ++s) {
    const EvolutionStage& stage = stages[s];
    const Point2 corner(kMargin + (s % columns) * (cell + kMargin),
                        kMargin + (s / columns) * rowHeight);
    panel.corner = corner + Point2((cell - panel.scale * extent.x()) / 2, kTitleHeight + above);
    // Of several viewpoints the first and the last.
    drawView(page, panel, view.points.front());
    if (view.points.size() > 1) drawView(page, panel, view.points.back());
    drawStage(page, panel, closed, view, stage);
    const std::size_t crossings = stage.crossings.size();
    anyCrossing = anyCrossing || crossings > 0;
    page.text(corner + Point2(0, 16),
              printed("(%c) ", 'a' + s % 26) + stage.title +
                  (crossings > 0 ? ", crossings " + std::to_string(crossings) : ""),
              kLetters, kInk, TextAnchor::Left);
    page.text(corner + Point2(0, 35),
              printed("visibility %.3f, flux variance %.3f, length %.2f", stage.visibility,
                      stage.variance, stage.length),
              0.9 * kLetters, report::kGrey, TextAnchor::Left);
  }
  drawLegend(page, rows * rowHeight + 20, panel.scale, anyCrossing);
  return page.svg();
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
