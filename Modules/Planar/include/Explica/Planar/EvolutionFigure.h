// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Planar/PolygonVisibility.h"

#include <array>
#include <string>
#include <vector>

namespace explica::planar {

/// One stage of a polygon's evolution.
struct EvolutionStage {
  std::string title;  ///< "start", "iteration 12"
  Positions2 positions;
  Region region;
  double visibility = 0;
  double variance = 0;
  double length = 0;                          ///< of the region, mm
  std::vector<std::array<int, 2>> crossings;  ///< pairs of edges that cross, each drawn as a ring
};

/// Draws stages side by side as SVG: the tissue filled, the region heavy, its edges shaded by their
/// flux, rings where edges cross, an arrow from the viewpoint's side in each panel (of several
/// viewpoints from the first and the last).  All panels have one scale; a legend says it.
///
/// @param stages  at least one, all of polygons or all of open chains
/// @return the whole SVG document
[[nodiscard]] std::string drawEvolution(bool closed, const Viewpoints& view,
                                        const std::vector<EvolutionStage>& stages);

/// Indices of `count` entries, first and last among them, whose values are most evenly spread.
[[nodiscard]] std::vector<std::size_t> evenStages(const std::vector<double>& values,
                                                  std::size_t count);

}  // namespace explica::planar
