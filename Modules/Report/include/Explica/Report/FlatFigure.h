// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/Canvas.h"
#include "Explica/Report/Figure.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace explica::report {

/// A piece of a line between regions, in the map, and the colour of the region on either side; of
/// what is no region, none.
struct FlatLine {
  Point from, to;
  std::optional<Colour> left, right;  ///< seen from above, on the way from `from` to `to`
};

/// What is drawn onto a flat map.
struct FlatMarks {
  std::vector<FlatLine> lines;                       ///< outlines of regions
  std::map<Colour, std::string> regions;             ///< what those of a colour are called
  std::vector<std::pair<Point, std::string>> names;  ///< what they are called, the largest first
  std::vector<std::pair<Eigen::Vector2d, std::string>> directions;  ///< unit vector in the map: "A"
};

/// A flat map seen from above with its colours, outlines, names, a scale bar of a round length,
/// a compass of the directions and a colour bar.  Each region has a line of its own along its
/// outline's inside, in its colour, with a dark one between; names have a white rim and keep off
/// each other: of those without room the smaller regions' are left out.
/// @param mesh  z = 0, counter-clockwise from above
[[nodiscard]] Picture flatFigure(const TriangleMesh& mesh, const SurfacePaint& paint,
                                 const FlatMarks& marks, int height = 900);

/// The same without the colour bar, in layers: the surface a picture, outlines by their regions'
/// names, names and scale as text.
[[nodiscard]] Canvas flatPanel(const TriangleMesh& mesh, const SurfacePaint& paint,
                               const FlatMarks& marks, int height);

/// The largest of 1, 2, 5, 10, 20 ... that is no more than a length.
[[nodiscard]] double roundLength(double length);

}  // namespace explica::report
