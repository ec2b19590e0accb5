// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Report/ColourMap.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::report {

/// Values on the vertices of an evolving surface.
struct EvolutionMap {
  Eigen::VectorXd values;  ///< V
  ColourScale scale;
};

/// Names on the vertices of an evolving surface.
struct EvolutionLabels {
  std::string title;
  std::vector<std::int32_t> entries;  ///< V: the entry of each vertex, -1 for none
  std::vector<LegendEntry> legend;
};

/// Another shape of the same vertices, such as the inflated surface.
struct EvolutionShape {
  std::string name;     ///< "white", "middle", "pial", "inflated", "sphere"
  Positions positions;  ///< V x 3, RAS mm; empty: those of the mesh itself
};

/// A surface of which some vertices move from frame to frame: what the interactive view plays.
struct Evolution {
  std::string title = {};                ///< "left": tells it from others on the page
  std::string scene = {};                ///< those of one scene are shown together
  std::vector<EvolutionShape> shapes;    ///< between which the view morphs, in this order
  TriangleMesh mesh;                     ///< as it is at the start
  std::vector<std::int32_t> moved;       ///< vertices that differ in any frame, ascending
  std::vector<Positions> frames;         ///< positions of `moved`; the first frame is the start
  std::vector<std::string> frameTitles;  ///< "iteration 12", one a frame
  std::vector<EvolutionMap> maps;
  std::vector<EvolutionLabels> labels;
  std::vector<std::int32_t> region;  ///< vertices of the region, ascending; empty: all that moved
  bool detached = false;  ///< the region was unfolded alone: it is shown apart from the surface
  std::optional<Point> viewpoint;  ///< RAS mm; the first view looks from there, at the region
};

/// The surface of several meshes with equal faces: finds what moved.
/// @throws InvalidInput  no mesh, or meshes that differ in faces or number of vertices
[[nodiscard]] Evolution evolutionOf(const std::vector<TriangleMesh>& frames);

/// The evolution as JSON for the page's script: positions quantised to 1/8191 of the box, frames
/// as differences, everything deflated.
[[nodiscard]] std::string evolutionJson(const Evolution& evolution);

}  // namespace explica::report
