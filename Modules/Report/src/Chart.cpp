// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Chart.h"

#include "Explica/Core/Html.h"
#include "Explica/Core/Text.h"
#include "Explica/Core/Types.h"
#include "Explica/Report/ColourMap.h"
#include "Explica/Report/Drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

namespace explica::report {
namespace {

constexpr double kWidth = 460;     // pixels
constexpr double kHeight = 260;    // pixels
constexpr double kLeft = 62;       // pixels, margin
constexpr double kRight = 14;      // pixels, margin
constexpr double kTop = 30;        // pixels, margin
constexpr double kBottom = 46;     // pixels, margin
constexpr int kBins = 48;          // of a histogram
constexpr double kLegendRow = 18;  // pixels, and the length of a line in it

std::string number(double value) {
  return printed("%.2f", value);
}

/// Three digits, never as a power of ten below a million.
std::string significant(double value) {
  const std::string text = printed("%.3g", value);
  const double rounded = std::stod(text);
  return std::abs(rounded) >= 1000 && std::abs(rounded) < 1e6 ? printed("%.0f", rounded) : text;
}

/// Axes and the map from values to the drawing; y is in powers of ten where it is logarithmic.
struct Axes {
  double x0, x1, y0, y1;
  bool logarithmic = false;
  bool counts = false;  ///< x are whole numbers, and ticks stand at such
  [[nodiscard]] double scaled(double y) const { return logarithmic ? std::log10(y) : y; }
  [[nodiscard]] double px(double x) const {
    return kLeft + (x - x0) / (x1 - x0) * (kWidth - kLeft - kRight);
  }
  [[nodiscard]] double py(double y) const {
    return kHeight - kBottom - (y - y0) / (y1 - y0) * (kHeight - kTop - kBottom);
  }
};

std::string text(double x, double y, std::string_view anchor, std::string_view content,
                 std::string_view extra = {}) {
  return "<text x='" + number(x) + "' y='" + number(y) + "' text-anchor='" + std::string(anchor) +
         "' " + std::string(extra) + ">" + escapeHtml(content) + "</text>";
}

/// Where ticks stand on the y axis: on a logarithmic one at powers of ten, or at 1, 2 and 5 times
/// these where it spans few of them.
std::vector<double> yTicksOf(const Axes& axes) {
  if (!axes.logarithmic) return roundTicks(axes.y0, axes.y1);
  std::vector<double> ticks;
  constexpr double kFewDecades = 2, kManyDecades = 7;
  const double decades = axes.y1 - axes.y0;
  const int every = decades > kManyDecades ? static_cast<int>(std::ceil(decades / 5)) : 1;
  for (int power = static_cast<int>(std::floor(axes.y0)); power <= axes.y1; power += every) {
    for (const double lead : {1.0, 2.0, 5.0}) {
      const double y = power + std::log10(lead);
      const bool wanted = lead == 1 || decades < kFewDecades;
      if (wanted && y >= axes.y0 && y <= axes.y1) ticks.push_back(y);
    }
  }
  return ticks;
}

/// What a tick on the y axis says.
std::string yTickText(const Axes& axes, double y) {
  if (!axes.logarithmic) return tickText(y, axes.y1 - axes.y0);
  return printed("%.3g", std::pow(10, y));
}

std::string head(const Axes& axes, const ChartText& titles, bool yTicks, double below = 0) {
  std::string svg = "<svg class='chart' viewBox='0 0 460 " + number(kHeight + below) +
                    "' role='img' aria-label='" + escapeHtml(titles.title) + "'>";
  svg += text(kWidth / 2, 18, "middle", titles.title, "class='chart-title'");
  svg += text((kLeft + kWidth - kRight) / 2, kHeight - 8, "middle", titles.xTitle);
  svg +=
      text(-(kTop + kHeight - kBottom) / 2, 14, "middle", titles.yTitle, "transform='rotate(-90)'");
  for (const double x : roundTicks(axes.x0, axes.x1, axes.counts ? 1 : 0)) {
    svg += "<path class='grid' d='M" + number(axes.px(x)) + " " + number(kTop) + "V" +
           number(kHeight - kBottom) + "'/>";
    svg += text(axes.px(x), kHeight - kBottom + 15, "middle", tickText(x, axes.x1 - axes.x0));
  }
  if (!yTicks) return svg;
  for (const double y : yTicksOf(axes)) {
    svg += "<path class='grid' d='M" + number(kLeft) + " " + number(axes.py(y)) + "H" +
           number(kWidth - kRight) + "'/>";
    svg += text(kLeft - 6, axes.py(y) + 4, "end", yTickText(axes, y));
  }
  return svg;
}

std::string nothing(const ChartText& titles) {
  return "<p class='chart-empty'>" + escapeHtml(titles.title) + ": no values to show.</p>";
}

}  // namespace

namespace {

std::vector<double> finiteInOrder(const Eigen::VectorXd& values) {
  std::vector<double> sorted;
  for (const double v : values) {
    if (std::isfinite(v)) sorted.push_back(v);
  }
  std::ranges::sort(sorted);
  return sorted;
}

std::array<double, kBins> sharesOf(const std::vector<double>& sorted, double low, double high) {
  std::array<double, kBins> share{};
  for (const double v : sorted) {
    if (v < low || v > high) continue;
    share[std::min(static_cast<int>((v - low) / (high - low) * kBins), kBins - 1)] +=
        1.0 / static_cast<double>(sorted.size());
  }
  return share;
}

/// Steps along the tops of bins.
std::string stepsOf(const std::array<double, kBins>& share, const Axes& axes) {
  std::string path = "M" + number(axes.px(axes.x0)) + " " + number(axes.py(0));
  for (int b = 0; b < kBins; ++b) {
    path += "V" + number(axes.py(share[b])) + "H" +
            number(axes.px(axes.x0 + (b + 1) * (axes.x1 - axes.x0) / kBins));
  }
  return path + "V" + number(axes.py(0));
}

/// Both ends of what a histogram shows: all but the outermost values.
std::array<double, 2> rangeShown(const std::vector<double>& sorted) {
  const std::size_t n = sorted.size();
  return {sorted[n / 200], sorted[n - 1 - n / 200]};
}

}  // namespace

std::string histogramSvg(const Eigen::VectorXd& values, const ChartText& titles) {
  const std::vector<double> sorted = finiteInOrder(values), behind = finiteInOrder(titles.behind);
  if (sorted.empty()) return nothing(titles);
  auto [low, high] = rangeShown(sorted);
  if (!behind.empty()) {
    const auto other = rangeShown(behind);
    low = std::min(low, other[0]);
    high = std::max(high, other[1]);
  }
  if (!(high > low)) {
    const double half = std::max(0.5, 0.5 * std::abs(low));
    low -= half;
    high += half;
  }
  const auto share = sharesOf(sorted, low, high), other = sharesOf(behind, low, high);
  const double most = std::max(*std::ranges::max_element(share), *std::ranges::max_element(other));
  const Axes axes{low, high, 0, 1.05 * most};
  std::string svg = head(axes, titles, true, behind.empty() ? 0 : kLegendRow);
  const double binWidth = (high - low) / kBins;
  for (int b = 0; b < kBins; ++b) {
    svg += "<rect class='bar' x='" + number(axes.px(low + b * binWidth)) + "' y='" +
           number(axes.py(share[b])) + "' width='" +
           number(0.92 * (axes.px(low + binWidth) - axes.px(low))) + "' height='" +
           number(axes.py(0) - axes.py(share[b])) + "'/>";
  }
  const double median = sorted[sorted.size() / 2];
  svg += "<path class='median' d='M" + number(axes.px(median)) + " " + number(kTop) + "V" +
         number(kHeight - kBottom) + "'/>";
  const bool late = axes.px(median) > 0.75 * kWidth;
  svg += text(axes.px(median) + (late ? -4 : 4), kTop + 10, late ? "end" : "start",
              "median " + significant(median));
  if (behind.empty()) return svg + "</svg>";
  svg += "<path class='behind' d='" + stepsOf(other, axes) + "'/>";
  const double y = kHeight + kLegendRow - 4;
  svg += "<path class='behind' d='M" + number(kLeft) + " " + number(y - 4) + "h" +
         number(kLegendRow) + "'/>" +
         text(kLeft + kLegendRow + 5, y, "start",
              titles.behindName + ", median " + significant(behind[behind.size() / 2]));
  return svg + "</svg>";
}

namespace {

/// Lower and upper edge of a curve's band at a point; both its value where it has none.
std::array<double, 2> bandAt(const Series& series, std::size_t i) {
  const double half = i < series.spread.size() ? series.spread[i] : 0;
  if (!std::isfinite(half)) return {series.y[i], series.y[i]};
  return {series.y[i] - half, series.y[i] + half};
}

/// The box of the curves' finite values, a little larger; all of it NaN-free.
std::optional<Axes> axesAround(const std::vector<Series>& series, bool logarithmic) {
  Axes axes{kInfinity, -kInfinity, kInfinity, -kInfinity, logarithmic, true};
  for (const Series& s : series) {
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
      const auto [below, above] = bandAt(s, i);
      const double low = axes.scaled(below), high = axes.scaled(above);
      if (!std::isfinite(s.x[i]) || !std::isfinite(low) || !std::isfinite(high)) continue;
      axes.x0 = std::min(axes.x0, s.x[i]);
      axes.x1 = std::max(axes.x1, s.x[i]);
      axes.counts = axes.counts && s.x[i] == std::round(s.x[i]);
      axes.y0 = std::min(axes.y0, low);
      axes.y1 = std::max(axes.y1, high);
    }
  }
  if (!(axes.x1 >= axes.x0)) return {};
  if (axes.x1 == axes.x0) axes.x1 = axes.x0 + 1;
  const double pad =
      axes.y1 > axes.y0 ? 0.06 * (axes.y1 - axes.y0) : std::max(0.5, 0.1 * std::abs(axes.y0));
  axes.y0 -= pad;
  axes.y1 += pad;
  return axes;
}

constexpr std::array<Label, 5> kHues = {5, 6, 3, 7, 1};  // colour-blind readers can tell them

std::string hueOf(std::size_t curve) {
  return hexText(colourOfLabel(kHues[curve % kHues.size()]));
}

/// How a curve is drawn: hues, then dashes.
std::string strokeOf(std::size_t curve) {
  return " stroke='" + hueOf(curve) + "'" + (curve < kHues.size() ? "" : " stroke-dasharray='6 3'");
}

/// A curve through its finite values; a dot if there is one only.
std::string curveOf(const Series& series, std::size_t curve, const Axes& axes) {
  std::string path, dot;
  for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
    const double y = axes.scaled(series.y[i]);
    if (!std::isfinite(y)) continue;
    const std::string px = number(axes.px(series.x[i])), py = number(axes.py(y));
    if (path.empty()) {
      dot = "<circle r='3' fill='" + hueOf(curve) + "' cx='" + px + "' cy='" + py + "'/>";
    } else {
      dot.clear();
    }
    path += (path.empty() ? "M" : "L") + px + " " + py;
  }
  return dot.empty() ? "<path class='line'" + strokeOf(curve) + " d='" + path + "'/>" : dot;
}

/// The outline of a curve's band; empty if it has none.
std::string bandOf(const Series& series, const Axes& axes) {
  std::string there, back;
  for (std::size_t i = 0; i < std::min(series.x.size(), series.spread.size()); ++i) {
    const auto [low, high] = bandAt(series, i);
    if (!std::isfinite(low) || !std::isfinite(high)) continue;
    const std::string x = number(axes.px(series.x[i])) + " ";
    there += (there.empty() ? "M" : "L") + x + number(axes.py(axes.scaled(high)));
    back = "L" + x + number(axes.py(axes.scaled(low))) + back;
  }
  return there.empty() ? "" : there + back + "Z";
}

/// Rows of names below the plot; the rows' number with it.
struct Legend {
  std::string svg;
  int rows = 0;
};

Legend legendOf(const std::vector<Series>& series) {
  constexpr double kLetter = 8.4, kGap = 24;  // pixels, of the page's letters
  Legend legend;
  if (series.size() < 2) return legend;
  legend.rows = 1;
  double x = kLeft;
  for (std::size_t s = 0; s < series.size(); ++s) {
    const double width = kLegendRow + kGap + kLetter * static_cast<double>(series[s].name.size());
    if (x > kLeft && x + width > kWidth) {
      x = kLeft;
      ++legend.rows;
    }
    const double y = kHeight + kLegendRow * legend.rows - 4;
    legend.svg += "<path class='line'" + strokeOf(s) + " d='M" + number(x) + " " + number(y - 4) +
                  "h" + number(kLegendRow) + "'/>";
    legend.svg += text(x + kLegendRow + 5, y, "start", series[s].name);
    x += width;
  }
  return legend;
}

}  // namespace

std::optional<std::array<double, 2>> rangeOf(const std::vector<Series>& series) {
  const std::optional<Axes> axes = axesAround(series, false);
  if (!axes) return {};
  return std::array{axes->y0, axes->y1};
}

std::string curvesSvg(const std::vector<Series>& series, const ChartText& titles) {
  bool positive = true;
  for (const Series& s : series) {
    for (const double y : s.y) positive = positive && !(y < 0);
  }
  std::optional<Axes> axes = axesAround(series, titles.logarithmic && positive);
  if (!axes) return nothing(titles);
  if (titles.yRange && !axes->logarithmic) {
    axes->y0 = (*titles.yRange)[0];
    axes->y1 = (*titles.yRange)[1];
  } else if (!titles.marks.empty()) {
    constexpr double kHeadroom = 0.1;  // of the height: no curve crosses a mark's name
    axes->y1 += kHeadroom * (axes->y1 - axes->y0);
  }
  const Legend legend = legendOf(series);
  std::string svg = head(*axes, titles, true, kLegendRow * legend.rows);
  for (const ChartMark& mark : titles.marks) {
    if (!(mark.x >= axes->x0 && mark.x <= axes->x1)) continue;
    const bool late = axes->px(mark.x) > 0.6 * kWidth;
    svg += "<path class='median' d='M" + number(axes->px(mark.x)) + " " + number(kTop) + "V" +
           number(kHeight - kBottom) + "'/>";
    svg += text(axes->px(mark.x) + (late ? -4 : 4), kTop + 10, late ? "end" : "start", mark.name);
  }
  for (std::size_t s = 0; s < series.size(); ++s) {
    const std::string band = bandOf(series[s], *axes);
    if (!band.empty()) {
      svg += "<path fill-opacity='0.18' fill='" + hueOf(s) + "' d='" + band + "'/>";
    }
  }
  for (std::size_t s = 0; s < series.size(); ++s) svg += curveOf(series[s], s, *axes);
  return svg + legend.svg + "</svg>";
}

}  // namespace explica::report
