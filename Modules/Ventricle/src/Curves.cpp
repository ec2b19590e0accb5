// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Canvas.h"
#include "Explica/Core/Text.h"
#include "Explica/Report/ColourMap.h"
#include "Explica/Ventricle/Pictures.h"
#include "Explica/Ventricle/Reference.h"

#include <cmath>
#include <functional>
#include <utility>

namespace explica::ventricle {

namespace {

constexpr double kWidth = 460, kTall = 320, kNotes = 96;  // of one curve, and of the lines below
constexpr double kMarginLeft = 70, kMarginRight = 24, kMarginTop = 56,
                 kMarginBottom = 58;  // pixels, margins

/// The range of healthy adults at one frame.
struct Range {
  std::size_t frame;
  Quantity quantity;
};

/// A quantity over the frames.
struct Curve {
  std::string title, unit;
  std::function<double(const Frame&)> value;
  std::vector<Range> ranges;
  std::vector<std::string> notes;  ///< below
};

/// A step of 1, 2 or 5 times a power of ten that gives about five ticks.
double tickStep(double range) {
  const double power = std::pow(10, std::floor(std::log10(range / 5)));
  const double lead = range / 5 / power;
  return power * (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10);
}

struct Axes {
  double x0, x1, y0, y1;
  Point2 corner;
  [[nodiscard]] Point2 at(double x, double y) const {
    return corner +
           Point2(
               kMarginLeft + (x - x0) / (x1 - x0) * (kWidth - kMarginLeft - kMarginRight),
               kTall - kMarginBottom - (y - y0) / (y1 - y0) * (kTall - kMarginTop - kMarginBottom));
  }
};

Axes axesOf(const Beat& beat, const Curve& curve, const Point2& corner) {
  double high = 0;
  for (const Frame& frame : beat.frames) {
    if (std::isfinite(curve.value(frame))) high = std::max(high, curve.value(frame));
  }
  for (const Range& range : curve.ranges) {
    const Reference& healthy = referenceOf(range.quantity);
    high = std::max({high, healthy.women.high(), healthy.men.high()});
  }
  if (high <= 0) high = 1;
  const double step = tickStep(high), first = beat.frames.front().number;
  const double last = std::max(first + 1, static_cast<double>(beat.frames.back().number));
  return {first, last, 0, step * std::ceil(1.02 * high / step), corner};
}

void drawAxes(Canvas& canvas, const Axes& axes, const Curve& curve) {
  const double step = tickStep(axes.y1);
  for (double y = 0; y <= axes.y1 * 1.0001; y += step) {
    canvas.stroke({axes.at(axes.x0, y), axes.at(axes.x1, y)}, kPale, 1);
    canvas.text(axes.at(axes.x0, y) + Point2(-8, 3.5), report::tickText(y, axes.y1), 7.5, kInk,
                report::TextAnchor::Right);
  }
  const double frames = std::max(1.0, std::ceil(tickStep(axes.x1 - axes.x0)));
  for (double x = axes.x0; x <= axes.x1 + 0.01; x += frames) {
    canvas.text(axes.at(x, 0) + Point2(0, 18), report::tickText(x, axes.x1 - axes.x0), 7.5, kInk);
  }
  canvas.stroke({axes.at(axes.x0, axes.y1), axes.at(axes.x0, 0), axes.at(axes.x1, 0)}, kInk, 1);
  canvas.text(axes.corner + Point2(0.5 * kWidth, 26), curve.title, 10, kInk);
  canvas.text(axes.corner + Point2(kMarginLeft - 8, 44), curve.unit, 7.5, kGrey,
              report::TextAnchor::Right);
  canvas.text(axes.corner + Point2(0.5 * (kMarginLeft + kWidth - kMarginRight), kTall - 18),
              "frame", 7.5, kGrey);
}

/// Women's range and men's beside the frame's mark: mean and 2 SD.
void drawRanges(Canvas& canvas, const Beat& beat, const Curve& curve, const Axes& axes) {
  constexpr double kNear = 14, kApart = 15, kHalfCap = 4;  // pixels
  constexpr double kLabel = 16;  // of the first frame's mark, which stands right of the axis
  for (const Range& range : curve.ranges) {
    const Reference& healthy = referenceOf(range.quantity);
    const double frame = beat.frames[range.frame].number;
    const bool last = axes.at(frame, 0)[0] > axes.corner[0] + kWidth - kMarginRight - 3 * kApart;
    double shift = last ? -kNear - kApart : kNear + (range.frame == 0 ? kLabel : 0);
    for (const auto& [spread, letter] :
         {std::pair{healthy.women, "w"}, std::pair{healthy.men, "m"}}) {
      const Point2 x(shift, 0), cap(kHalfCap, 0);
      const Point2 low = axes.at(frame, spread.low()) + x, high = axes.at(frame, spread.high()) + x;
      const Point2 mean = axes.at(frame, spread.mean) + x;
      canvas.stroke({low, high}, kGrey, 1);
      for (const Point2& end : {low, mean, high}) canvas.stroke({end - cap, end + cap}, kGrey, 1);
      canvas.text(high + Point2(0, -4), letter, 6, kGrey);
      shift += kApart;
    }
  }
}

void drawCurve(Canvas& canvas, const Beat& beat, const Curve& curve, const Point2& corner) {
  const Axes axes = axesOf(beat, curve, corner);
  drawAxes(canvas, axes, curve);
  drawRanges(canvas, beat, curve, axes);
  const report::Colour colour = report::colourAt(report::ColourMap::Sequential, 0.35);
  std::vector<Point2> line;
  for (std::size_t f = 0; f < beat.frames.size(); ++f) {
    const double value = curve.value(beat.frames[f]);
    if (!std::isfinite(value)) continue;
    const Point2 at = axes.at(beat.frames[f].number, value);
    line.push_back(at);
    canvas.rectangle(at - Point2(2.5, 2.5), {5, 5}, colour);
    const Point2 above = at + Point2(f == 0 ? 12 : 0, -9);  // clear of the axis
    if (f == beat.diastole) canvas.text(above, "ED", 7.5, kInk);
    if (f == beat.systole && f != beat.diastole) canvas.text(above, "ES", 7.5, kInk);
  }
  if (line.size() > 1) canvas.stroke(line, colour, 2);
  double y = kTall + 12;
  for (const std::string& note : curve.notes) {
    canvas.text(corner + Point2(24, y), note, 7, kGrey, report::TextAnchor::Left);
    y += 14;
  }
}

/// What the bars are, and where the numbers come from.
std::vector<std::string> volumeNotes(const Beat& beat) {
  const Reference &volume = referenceOf(Quantity::DiastolicVolume),
                  &ejection = referenceOf(Quantity::Ejection);
  std::vector<std::string> notes = {"bars: healthy women (w) and men (m), mean and 2 SD",
                                    volume.source, volume.people};
  if (beat.ejectionFraction) {
    notes.push_back(printed("ejection fraction here %.0f %%, healthy ", *beat.ejectionFraction) +
                    rangeText(ejection));
    notes.push_back(ejection.source);
  }
  return notes;
}

std::vector<Curve> curvesOf(const Beat& beat) {
  const Reference& mass = referenceOf(Quantity::Mass);
  return {{"Volume of the cavity",
           "ml",
           [](const Frame& f) { return f.cavity; },
           {{beat.diastole, Quantity::DiastolicVolume}, {beat.systole, Quantity::SystolicVolume}},
           volumeNotes(beat)},
          {"Mean thickness of the wall",
           "mm",
           [](const Frame& f) { return f.thickness; },
           {},
           {"of the whole wall, ranges of its rings: bullseye.svg, reference.tsv"}},
          {"Mass of the wall",
           "g",
           [](const Frame& f) { return f.mass; },
           {{beat.diastole, Quantity::Mass}},
           {"bars: healthy women (w) and men (m), mean and 2 SD,", "papillary muscles in the wall",
            mass.source}}};
}

}  // namespace

Drawn beatCurves(const Beat& beat) {
  const std::vector<Curve> curves = curvesOf(beat);
  Canvas canvas(static_cast<int>(kWidth * static_cast<double>(curves.size())),
                static_cast<int>(kTall + kNotes));
  for (std::size_t c = 0; c < curves.size(); ++c) {
    drawCurve(canvas, beat, curves[c], {kWidth * static_cast<double>(c), 0});
  }
  return {canvas.svg(), canvas.picture(2)};
}

}  // namespace explica::ventricle
