// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0

#include "Plots.h"

#include "Explica/Core/Html.h"

#include <algorithm>
#include <cmath>

namespace explica::app {
std::string reportOf(const Observations& o, std::size_t person) {
  const auto column = o.about.find("report");
  if (!column || statistics::isMissing(o.about.rows[person][*column])) return {};
  return o.about.rows[person][*column];
}

Axis axisOf(const Observations& o, const GlmResults& r, const statistics::Contrast& contrast) {
  const statistics::Factor* factor = nullptr;
  for (std::size_t c = 0; c < r.design.columns.size(); ++c) {
    if (contrast.weights.row(static_cast<Eigen::Index>(c)).isZero()) continue;
    for (const std::string& name : r.design.terms[static_cast<std::size_t>(r.design.termOf[c])]) {
      for (const auto& f : r.design.factors) {
        if (f.name == name && (factor == nullptr || f.levels.empty())) factor = &f;
      }
    }
  }
  Axis axis;
  if (factor == nullptr) {
    axis.name = "people";
    for (std::size_t i = 0; i < o.people.size(); ++i) axis.x.push_back(static_cast<double>(i));
    return axis;
  }
  axis.name = factor->name;
  axis.levels = factor->levels;
  for (const auto& row : o.about.rows) {
    const std::string& cell = row[o.about.at(factor->name)];
    if (factor->levels.empty()) {
      axis.x.push_back(statistics::numberIn(cell).value_or(std::nan("")));
    } else {
      const auto level = std::find(factor->levels.begin(), factor->levels.end(), cell);
      axis.x.push_back(static_cast<double>(level - factor->levels.begin()));
    }
  }
  return axis;
}

namespace {

constexpr std::size_t kMostNamed = 1000;  // people whose points say who they are: 100 bytes each

/// People's points; those of many are one path without names, which the plot of a clicked place
/// has.
/// @param px, py  from values to the picture
template <class X, class Y>
std::string pointsSvg(const Observations& o, const Axis& axis, const Eigen::VectorXd& y,
                      const X& px, const Y& py) {
  const bool named = o.people.size() <= kMostNamed;
  std::string svg, path;
  for (std::size_t i = 0; i < o.people.size(); ++i) {
    const double value = y[static_cast<Eigen::Index>(i)];
    if (!std::isfinite(value) || !std::isfinite(axis.x[i])) continue;
    // Of a level, people are spread in the order of the table.
    const double aside =
        axis.levels.empty() ? 0 : (static_cast<double>(i * 37 % 61) / 61 - 0.5) * 0.5;
    const std::string cx = numberText(px(axis.x[i] + aside), 5), cy = numberText(py(value), 5);
    if (!named) {
      path += "M" + cx + " " + cy + "h0";
      continue;
    }
    const std::string link = reportOf(o, i);
    if (!link.empty()) svg += "<a href='" + escapeHtml(link) + "'>";
    svg += "<circle cx='" + cx + "' cy='" + cy +
           "' r='2.6' fill='#145ab4' fill-opacity='0.6'><title>" + escapeHtml(o.people[i]) + ": " +
           numberText(value, 4) + "</title></circle>" + (link.empty() ? "" : "</a>");
  }
  if (named) return svg;
  return "<path class='people' fill='none' stroke='#145ab4' stroke-opacity='0.6' stroke-width='3' "
         "stroke-linecap='round' d='" +
         path + "'/>";
}

}  // namespace

std::string scatterSvg(const Observations& o, const Axis& axis, const Eigen::VectorXd& y,
                       const std::string& title) {
  constexpr double kPlotWidth = 420, kPlotHeight = 260, kLeft = 56, kBottom = 42, kTop = 26;
  double x0 = *std::min_element(axis.x.begin(), axis.x.end()),
         x1 = *std::max_element(axis.x.begin(), axis.x.end());
  double y0 = std::nan(""), y1 = std::nan("");
  for (const double v : y) {
    y0 = std::fmin(y0, v);
    y1 = std::fmax(y1, v);
  }
  const double margin = axis.levels.empty() ? (x1 - x0) * 0.03 : 0.5;
  x0 -= margin;
  x1 += margin;
  const auto px = [&](double x) {
    return kLeft + (x - x0) / (x1 - x0) * (kPlotWidth - kLeft - 10);
  };
  const auto py = [&](double v) {
    return kPlotHeight - kBottom -
           (v - y0) / std::max(y1 - y0, 1e-12) * (kPlotHeight - kBottom - kTop);
  };
  std::string svg = "<svg viewBox='0 0 420 260' role='img' aria-label='" + escapeHtml(title) +
                    "' xmlns='http://www.w3.org/2000/svg' font-family='sans-serif' font-size='12'>"
                    "<text x='10' y='16' font-weight='600'>" +
                    escapeHtml(title) + "</text>";
  const auto label = [&](double x, double yy, const std::string& text, const char* anchor) {
    svg += "<text x='" + numberText(x, 5) + "' y='" + numberText(yy, 5) + "' text-anchor='" +
           anchor + "'>" + escapeHtml(text) + "</text>";
  };
  label(kLeft - 6, py(y0) + 4, numberText(y0, 3), "end");
  label(kLeft - 6, py(y1) + 4, numberText(y1, 3), "end");
  if (axis.levels.empty()) {
    label(px(x0 + margin), kPlotHeight - kBottom + 16, numberText(x0 + margin, 4), "middle");
    label(px(x1 - margin), kPlotHeight - kBottom + 16, numberText(x1 - margin, 4), "middle");
  }
  for (std::size_t l = 0; l < axis.levels.size(); ++l) {
    label(px(static_cast<double>(l)), kPlotHeight - kBottom + 16, axis.levels[l], "middle");
  }
  label(kPlotWidth / 2 + kLeft / 2, kPlotHeight - 8, axis.name, "middle");
  svg += "<path d='M56 26V218H410' fill='none' stroke='#888'/>";
  return svg + pointsSvg(o, axis, y, px, py) + "</svg>";
}

}  // namespace explica::app
