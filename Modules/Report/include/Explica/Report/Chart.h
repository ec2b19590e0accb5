// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace explica::report {

/// One line of a chart.
struct Series {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;  ///< as long as x; what is not finite is left out
  /// Half the height of a band about the line, as long as y, or empty for none.
  std::vector<double> spread = {};
};

/// A moment worth marking on the x axis.
struct ChartMark {
  double x = 0;
  std::string name;
};

/// What stands around a chart.
struct ChartText {
  std::string title;
  std::string xTitle;  ///< with unit
  std::string yTitle;
  bool logarithmic = false;           ///< the y axis, where all values are positive
  std::vector<ChartMark> marks = {};  ///< of curves
  /// First and last value on the y axis of curves; without, what the curves need.
  std::optional<std::array<double, 2>> yRange = {};
  /// Other values drawn behind a histogram's as a line, each of its bins as a share of theirs.
  Eigen::VectorXd behind = {};
  std::string behindName = {};  ///< "before", "study of 20"
};

/// Lowest and highest value of curves with their bands, to give several charts one axis; none
/// where nothing is finite.
[[nodiscard]] std::optional<std::array<double, 2>> rangeOf(const std::vector<Series>& series);

/// How often values occur, as a self-contained SVG element; from the 0.5th to the 99.5th
/// percentile, with the median marked, of what is drawn behind too.  A sentence says so where there
/// is nothing to show.
[[nodiscard]] std::string histogramSvg(const Eigen::VectorXd& values, const ChartText& text);

/// Lines over a common axis, as a self-contained SVG element, with a legend below if there are
/// several.
[[nodiscard]] std::string curvesSvg(const std::vector<Series>& series, const ChartText& text);

}  // namespace explica::report
