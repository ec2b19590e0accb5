// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <string>
#include <vector>

namespace explica::app {

/// A row of FreeSurfer's `?h.aparc.stats`; NaN: not known.
struct StatsRow {
  std::string name;
  Eigen::Index vertices = 0;
  double area = kNaN;                ///< mm^2
  double volume = kNaN;              ///< mm^3
  double thicknessMean = kNaN;       ///< mm, over vertices
  double thicknessDeviation = kNaN;  ///< mm, with n
  double meanCurvature = kNaN;       ///< mm^-1, mean of the absolute value over the area
};

/// What the head of the file says.
struct StatsHead {
  std::string subject, hemisphere, atlas;
};

/// Text of a `.stats` file of FreeSurfer's form: the head's measures of the whole cortex (all
/// regions together), and the first seven of FreeSurfer's ten columns.
/// @param cortex  all regions together
[[nodiscard]] std::string statsText(const StatsHead& head, const StatsRow& cortex,
                                    const std::vector<StatsRow>& rows);

}  // namespace explica::app
