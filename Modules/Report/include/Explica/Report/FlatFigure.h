// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/Drawing.h"
#include "Explica/Report/Figure.h"

#include <string>
#include <utility>
#include <vector>

namespace explica::report {

/// What is drawn onto a flat map.
struct FlatMarks {
  std::vector<std::pair<Point, Point>> lines;        ///< outlines of regions, in the map
  std::vector<std::pair<Point, std::string>> names;  ///< and what they are called
};

/// A flat map seen from above with its colours, outlines, names, a scale bar of a round length and
/// a colour bar.
/// @param mesh  z = 0, counter-clockwise from above
[[nodiscard]] Picture flatFigure(const TriangleMesh& mesh, const SurfacePaint& paint,
                                 const FlatMarks& marks, int height = 900);

/// The largest of 1, 2, 5, 10, 20 ... that is no more than a length.
[[nodiscard]] double roundLength(double length);

}  // namespace explica::report
