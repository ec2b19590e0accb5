// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#include "Explica/Report/Chart.h"

#include "Explica/Core/Types.h"
#include "Explica/Report/ColourMap.h"
#include "Explica/Report/Drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace explica::report {
namespace {

constexpr double kWidth = 460;
constexpr double kHeight = 260;
constexpr double kLeft = 62;
constexpr double kRight = 14;
constexpr double kTop = 30;
constexpr double kBottom = 46;
constexpr int kBins = 48;

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f", value);
  return text.data();
}

std::string hex(const Colour& colour) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "#%02x%02x%02x", encodeSrgb(colour[0]),
                encodeSrgb(colour[1]), encodeSrgb(colour[2]));
  return text.data();
}

/// A step of 1, 2 or 5 times a power of ten that gives about five ticks.
double tickStep(double range) {
  const double raw = range / 5;
  const double power = std::pow(10, std::floor(std::log10(raw)));
  const double lead = raw / power;
  return power * (lead < 1.5 ? 1 : (lead < 3.5 ? 2 : (lead < 7.5 ? 5 : 10)));
}

/// Axes and the map from values to the drawing.
struct Axes {
  double x0, x1, y0, y1;
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

std::string head(const Axes& axes, const ChartText& titles, bool yTicks) {
  std::string svg = "<svg class='chart' viewBox='0 0 460 260' role='img' aria-label='" +
                    escapeHtml(titles.title) + "'>";
  svg += text(kWidth / 2, 18, "middle", titles.title, "class='chart-title'");
  svg += text((kLeft + kWidth - kRight) / 2, kHeight - 8, "middle", titles.xTitle);
  svg +=
      text(-(kTop + kHeight - kBottom) / 2, 14, "middle", titles.yTitle, "transform='rotate(-90)'");
  const double dx = tickStep(axes.x1 - axes.x0);
  for (double x = std::ceil(axes.x0 / dx - 1e-9) * dx; x <= axes.x1 + 1e-9 * dx; x += dx) {
    svg += "<path class='grid' d='M" + number(axes.px(x)) + " " + number(kTop) + "V" +
           number(kHeight - kBottom) + "'/>";
    svg += text(axes.px(x), kHeight - kBottom + 15, "middle", tickText(x, axes.x1 - axes.x0));
  }
  if (yTicks) {
    const double dy = tickStep(axes.y1 - axes.y0);
    for (double y = std::ceil(axes.y0 / dy - 1e-9) * dy; y <= axes.y1 + 1e-9 * dy; y += dy) {
      svg += "<path class='grid' d='M" + number(kLeft) + " " + number(axes.py(y)) + "H" +
             number(kWidth - kRight) + "'/>";
      svg += text(kLeft - 6, axes.py(y) + 4, "end", tickText(y, axes.y1 - axes.y0));
    }
  }
  return svg;
}

std::string nothing(const ChartText& titles) {
  return "<p class='chart-empty'>" + escapeHtml(titles.title) + ": no values to show.</p>";
}

}  // namespace

std::string escapeHtml(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string histogramSvg(const Eigen::VectorXd& values, const ChartText& titles) {
  std::vector<double> sorted;
  for (const double v : values) {
    if (std::isfinite(v)) sorted.push_back(v);
  }
  if (sorted.empty()) return nothing(titles);
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  double low = sorted[n / 200];
  double high = sorted[n - 1 - n / 200];
  if (!(high > low)) {
    const double half = std::max(0.5, 0.5 * std::abs(low));
    low -= half;
    high += half;
  }
  std::array<std::size_t, kBins> count{};
  for (const double v : sorted) {
    if (v < low || v > high) continue;
    ++count[std::min(static_cast<int>((v - low) / (high - low) * kBins), kBins - 1)];
  }
  const double most = static_cast<double>(*std::max_element(count.begin(), count.end()));
  const Axes axes{low, high, 0, 1.05 * most / static_cast<double>(n)};
  std::string svg = head(axes, titles, true);
  const double binWidth = (high - low) / kBins;
  for (int b = 0; b < kBins; ++b) {
    const double share = static_cast<double>(count[b]) / static_cast<double>(n);
    svg += "<rect class='bar' x='" + number(axes.px(low + b * binWidth)) + "' y='" +
           number(axes.py(share)) + "' width='" +
           number(0.92 * (axes.px(low + binWidth) - axes.px(low))) + "' height='" +
           number(axes.py(0) - axes.py(share)) + "'/>";
  }
  const double median = sorted[n / 2];
  svg += "<path class='median' d='M" + number(axes.px(median)) + " " + number(kTop) + "V" +
         number(kHeight - kBottom) + "'/>";
  svg += text(axes.px(median) + 4, kTop + 10, "start", "median " + tickText(median, high - low));
  return svg + "</svg>";
}

std::string curvesSvg(const std::vector<Series>& series, const ChartText& titles) {
  Axes axes{kInfinity, -kInfinity, kInfinity, -kInfinity};
  for (const Series& s : series) {
    for (std::size_t i = 0; i < std::min(s.x.size(), s.y.size()); ++i) {
      if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i])) continue;
      axes.x0 = std::min(axes.x0, s.x[i]);
      axes.x1 = std::max(axes.x1, s.x[i]);
      axes.y0 = std::min(axes.y0, s.y[i]);
      axes.y1 = std::max(axes.y1, s.y[i]);
    }
  }
  if (!(axes.x1 >= axes.x0)) return nothing(titles);
  if (axes.x1 == axes.x0) axes.x1 = axes.x0 + 1;
  const double pad =
      axes.y1 > axes.y0 ? 0.06 * (axes.y1 - axes.y0) : std::max(0.5, 0.1 * std::abs(axes.y0));
  axes.y0 -= pad;
  axes.y1 += pad;
  std::string svg = head(axes, titles, true);
  const std::array<Label, 5> hues = {5, 6, 3, 7, 1};
  for (std::size_t s = 0; s < series.size(); ++s) {
    const std::string colour = hex(colourOfLabel(hues[s % hues.size()]));
    std::string path;
    for (std::size_t i = 0; i < std::min(series[s].x.size(), series[s].y.size()); ++i) {
      if (!std::isfinite(series[s].y[i])) continue;
      path += (path.empty() ? "M" : "L") + number(axes.px(series[s].x[i])) + " " +
              number(axes.py(series[s].y[i]));
    }
    svg += "<path class='line' stroke='" + colour + "' d='" + path + "'/>";
    if (series.size() > 1) {
      const double y = kTop + 14 + 15 * static_cast<double>(s);
      svg += "<path class='line' stroke='" + colour + "' d='M" + number(kLeft + 10) + " " +
             number(y - 4) + "h18'/>";
      svg += text(kLeft + 34, y, "start", series[s].name);
    }
  }
  return svg + "</svg>";
}

}  // namespace explica::report
