// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Results.h"

namespace explica::app {

/// A plot's horizontal axis: the first column of the contrast's terms.
struct Axis {
  std::string name;
  std::vector<double> x;
  std::vector<std::string> levels;  ///< of a categorical column
};
[[nodiscard]] Axis axisOf(const Observations& observations, const GlmResults& results,
                          const statistics::Contrast& contrast);

/// The person's report, relative to the page's folder; empty if it is not known.
[[nodiscard]] std::string reportOf(const Observations& observations, std::size_t person);

/// Each person at one place, as an SVG element; a point names the person and leads to the person's
/// report, where the table has the column `report`.
[[nodiscard]] std::string scatterSvg(const Observations& observations, const Axis& axis,
                                     const Eigen::VectorXd& values, const std::string& title);

/// The same of whatever place is clicked on the page's surface, as a section with script and data:
/// of so many people that their values at all places would make a page of more than some MB, of
/// places evenly among them.
/// @param values  N x V
[[nodiscard]] std::string placePlot(const Observations& observations, const GlmResults& results,
                                    const Eigen::MatrixXd& values);

}  // namespace explica::app
