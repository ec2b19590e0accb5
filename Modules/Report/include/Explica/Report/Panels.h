// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/FlatFigure.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::report {

/// A surface from one side, or a flat map from above.
struct Panel {
  const TriangleMesh* mesh = nullptr;  ///< not owned
  SurfacePaint paint;
  ViewName view = ViewName::Left;
  std::optional<FlatMarks> marks = {};  ///< given: a flat map
  std::string title;
};

/// Rows of panels, surfaces all at one scale, with one colour bar at the right; layers of the
/// pictures, the outlines and names of regions, the titles and the colour bar.
/// @param scale  of the colour bar; none: no bar
/// @param width  pixels, > 0
/// @throws InvalidInput  no panel
[[nodiscard]] Canvas panelFigure(const std::vector<std::vector<Panel>>& rows,
                                 const std::optional<ColourScale>& scale, int width);

}  // namespace explica::report
