// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Core/Text.h"
#include "Explica/Report/Canvas.h"
#include "Explica/Report/ColourMap.h"
#include "Explica/Ventricle/Pictures.h"
#include "Explica/Ventricle/Reference.h"

#include <array>
#include <cmath>
#include <functional>

namespace explica::ventricle {

namespace {

using report::Canvas;
using report::Colour;
using report::kGrey;
using report::kInk;
using report::kWhite;
using report::Point2;
using report::TextAnchor;

constexpr double kPanel = 480, kHeight = 590;                                   // of one bull's-eye
constexpr double kRadius = 150, kMiddleX = 220, kMiddleY = 270;                 // pixels
constexpr double kBarX = 420, kBarTop = 130, kBarHeight = 280, kBarWidth = 16;  // pixels

constexpr Colour kPale = {0.78F, 0.79F, 0.80F};  // what is not known

/// Black or white, whichever is read better on a colour.
Colour inkOn(const Colour& ground) {
  // Where black and white have the same contrast, (Y + 0.05)^2 = 1.05 * 0.05.
  const double light = 0.2126 * ground[0] + 0.7152 * ground[1] + 0.0722 * ground[2];
  return light > 0.18 ? kInk : kWhite;
}

/// What a bull's-eye shows.
struct Panel {
  std::string title, unit;
  int digits = 1;
  report::ColourScale scale;
  std::function<double(const Segment&)> value;
  const Frame* frame = nullptr;
  std::vector<std::string> notes;  ///< below
  double normalLow = kNaN, normalHigh = kNaN;
};

/// Point of the bull's-eye: share of its radius, degrees counter-clockwise from the right.
Point2 place(double share, double degrees) {
  const double a = degrees * kPi / 180;
  return {kMiddleX + share * kRadius * std::cos(a), kMiddleY - share * kRadius * std::sin(a)};
}

/// Where a segment lies: shares of the radius, first angle, width.
struct Sector {
  double inner, outer, first, width;
};

Sector sectorOf(int number) {
  if (number == kSegments) return {0, 0.25, 0, 360};
  const int third = (number - 1) / 6, n = (number - 1) % 6;
  const double outer = 1 - 0.25 * third;
  if (third < 2) return {outer - 0.25, outer, 60.0 + 60 * n, 60};
  return {outer - 0.25, outer, 45.0 + 90 * n, 90};
}

std::vector<Point2> outlineOf(const Sector& s) {
  std::vector<Point2> points;
  const int steps = static_cast<int>(s.width / 3);
  for (int q = 0; q <= steps; ++q) points.push_back(place(s.outer, s.first + s.width * q / steps));
  if (s.inner == 0) return points;
  for (int q = steps; q >= 0; --q) points.push_back(place(s.inner, s.first + s.width * q / steps));
  return points;
}

void drawSegment(Canvas& canvas, const Point2& corner, const Panel& panel, const Segment& row) {
  const Sector sector = sectorOf(row.number);
  const double value = panel.value(row);
  const bool known = std::isfinite(value);
  const Colour ground = known ? panel.scale(value) : kPale;
  std::vector<Point2> outline;
  for (const Point2& p : outlineOf(sector)) outline.emplace_back(corner + p);
  canvas.fill(outline, ground);
  canvas.stroke(outline, kWhite, 2, true);
  const Point2 middle = corner + (sector.inner == 0 ? Point2(kMiddleX, kMiddleY)
                                                    : place(0.5 * (sector.inner + sector.outer),
                                                            sector.first + 0.5 * sector.width));
  const Colour ink = inkOn(ground);
  canvas.text(middle + Point2(0, 1), known ? printed("%.*f", panel.digits, value) : "n/a", 11, ink);
  canvas.text(middle + Point2(0, 14), std::to_string(row.number), 9, ink);
}

void drawNames(Canvas& canvas, const Point2& corner, bool oriented) {
  if (!oriented) {
    canvas.text(corner + Point2(kMiddleX, kMiddleY - kRadius - 16),
                "not oriented: no right ventricle was given", 9, kInk);
    return;
  }
  const std::array<const char*, 6> names = {"anterior", "antero-", "infero-",
                                            "inferior", "infero-", "antero-"};
  const std::array<const char*, 6> second = {"", "septal", "septal", "", "lateral", "lateral"};
  for (int n = 0; n < 6; ++n) {
    const double degrees = 90 + 60 * n;
    Point2 at = corner + place(1.06, degrees);
    const double side = std::cos(degrees * kPi / 180);
    const TextAnchor anchor = side < -0.1  ? TextAnchor::Right
                              : side > 0.1 ? TextAnchor::Left
                                           : TextAnchor::Middle;
    if (n == 3) at[1] += 10;
    canvas.text(at, names[n], 9, kInk, anchor);
    if (*second[n] != '\0') canvas.text(at + Point2(0, 13), second[n], 9, kInk, anchor);
  }
}

void drawBar(Canvas& canvas, const Point2& corner, const Panel& panel) {
  const double low = panel.scale.low, high = panel.scale.high;
  const auto heightOf = [&](double value) {
    return kBarTop + kBarHeight * (1 - (value - low) / (high - low));
  };
  report::ColourScale scale = panel.scale;
  scale.title = panel.unit;
  scale.unit.clear();
  drawColourBar(canvas, scale, corner + Point2(kBarX, kBarTop), {kBarWidth, kBarHeight}, 9);
  if (!(panel.normalLow < high && panel.normalHigh > low)) return;
  const double top = heightOf(std::min(high, panel.normalHigh));
  const double bottom = heightOf(std::max(low, panel.normalLow));
  const Point2 x = corner + Point2(kBarX - 7, 0);
  canvas.stroke(
      {x + Point2(4, top), x + Point2(0, top), x + Point2(0, bottom), x + Point2(4, bottom)}, kInk,
      1.5);
  canvas.text(corner + Point2(kBarX - 12, 0.5 * (top + bottom) + 3), "*", 9, kInk,
              TextAnchor::Right);
}

void drawPanel(Canvas& canvas, const Point2& corner, const Panel& panel, bool oriented) {
  canvas.text(corner + Point2(0.5 * kPanel, 34), panel.title, 12, kInk);
  canvas.text(
      corner + Point2(0.5 * kPanel, 56),
      "frame " + std::to_string(panel.frame->number) + ", mean of each segment, " + panel.unit, 9,
      kGrey);
  for (const Segment& row : panel.frame->segments->rows) drawSegment(canvas, corner, panel, row);
  drawNames(canvas, corner, oriented);
  drawBar(canvas, corner, panel);
  double y = kMiddleY + kRadius + 50;
  for (const std::string& note : panel.notes) {
    canvas.text(corner + Point2(10, y), note, 9, kGrey, TextAnchor::Left);
    y += 17;
  }
}

/// A scale over the values of a few frames, from a tenth-percentile-free range: all are shown.
report::ColourScale scaleOf(const std::vector<double>& values, const std::string& unit,
                            bool diverging) {
  report::ColourScale scale;
  scale.unit = unit;
  double low = kInfinity, high = -kInfinity;
  for (const double v : values) {
    if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  }
  if (!(low <= high)) low = 0, high = 1;
  if (diverging) {
    const double reach = 10 * std::ceil(std::max({std::abs(low), std::abs(high), 10.0}) / 10);
    scale.map = report::ColourMap::Diverging;
    scale.low = -reach, scale.high = reach;
  } else {
    scale.low = std::floor(low), scale.high = std::max(std::ceil(high), scale.low + 1);
  }
  return scale;
}

std::string leftOutNote(const Frame& frame) {
  std::size_t left = 0, counted = 0;
  for (const Segment& row : frame.segments->rows) left += row.leftOut, counted += row.voxels;
  return std::to_string(left) + " of " + std::to_string(left + counted) +
         " wall voxels left out: openings, valve, apex";
}

std::string here(const Beat& beat, Quantity quantity) {
  return cellText(valueOf(beat, quantity), "%.1f");
}

/// Thickness of healthy adults and of this heart.
std::vector<std::string> thicknessNotes(const Beat& beat) {
  const Reference& healthy = referenceOf(Quantity::MiddleThickness);
  return {leftOutNote(beat.atDiastole()),
          "rings from outside: basal, middle, apical, and the apex",
          "* healthy adults, middle ring, within 2 SD (here " +
              here(beat, Quantity::MiddleThickness) + " mm):",
          rangeText(healthy),
          healthy.people,
          healthy.source};
}

/// Thickening of healthy adults and of this heart, which was published in mm.
std::vector<std::string> thickeningNotes(const Beat& beat) {
  std::vector<std::string> notes = {"100 x (end-systole - end-diastole) / end-diastole",
                                    "in mm, means of rings:"};
  for (const auto& [quantity, name] : {std::pair{Quantity::BasalThickening, "basal "},
                                       std::pair{Quantity::MiddleThickening, "middle "},
                                       std::pair{Quantity::ApicalThickening, "apical "}}) {
    notes.push_back(name + here(beat, quantity) + ", healthy " + rangeText(referenceOf(quantity)));
  }
  const Reference& healthy = referenceOf(Quantity::BasalThickening);
  notes.push_back(healthy.people);
  notes.push_back(healthy.source);
  return notes;
}

std::vector<Panel> panelsOf(const Beat& beat) {
  const Frame& diastole = beat.atDiastole();
  const Frame& systole = beat.atSystole();
  const bool both = beat.systole != beat.diastole && systole.segments;
  std::vector<double> lengths, changes;
  for (const Segment& row : diastole.segments->rows) lengths.push_back(row.thickness);
  if (both) {
    for (const Segment& row : systole.segments->rows) {
      lengths.push_back(row.thickness);
      changes.push_back(row.thickening);
    }
  }
  const auto thickness = [](const Segment& row) { return row.thickness; };
  const report::ColourScale scale = scaleOf(lengths, "mm", false);
  std::vector<Panel> panels;
  const Reference& healthy = referenceOf(Quantity::MiddleThickness);
  const Panel first{"Wall thickness at end-diastole",
                    "mm",
                    1,
                    scale,
                    thickness,
                    &diastole,
                    thicknessNotes(beat),
                    healthy.women.low(),
                    healthy.men.high()};
  panels.push_back(first);
  if (!both) return panels;
  panels.push_back({"Wall thickness at end-systole",
                    "mm",
                    1,
                    scale,
                    thickness,
                    &systole,
                    {leftOutNote(systole), "same colours as at end-diastole",
                     "of systolic thickness no range is given: see thickening in mm"}});
  panels.push_back({"Thickening from end-diastole to end-systole", "%", 0,
                    scaleOf(changes, "%", true), [](const Segment& row) { return row.thickening; },
                    &systole, thickeningNotes(beat)});
  return panels;
}

}  // namespace

Drawn bullseye(const Beat& beat) {
  const std::vector<Panel> panels = panelsOf(beat);
  Canvas canvas(static_cast<int>(kPanel * static_cast<double>(panels.size())),
                static_cast<int>(kHeight));
  for (std::size_t p = 0; p < panels.size(); ++p) {
    canvas.layer(panels[p].title);
    drawPanel(canvas, {kPanel * static_cast<double>(p), 0}, panels[p], beat.oriented());
  }
  return {canvas.svg(), canvas.picture(2)};
}

}  // namespace explica::ventricle
