// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Statistics/Inference.h"
#include "Explica/Statistics/Table.h"
#include "Settings.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// A surface that maps are on, and where its vertices stand among all places.
struct MapSide {
  std::string prefix;     ///< of its files: "hemi-L_", or empty if there is one surface
  std::string structure;  ///< "CortexLeft", "CortexRight", "Other"
  Eigen::Index first = 0, count = 0;
  std::vector<std::string> regions;  ///< name of each vertex's region; empty without an atlas
};

/// Everybody's values: where they are read from, and what is known of the people.
struct Observations {
  std::vector<std::string> people;
  statistics::Table about;  ///< a row a person, in their order
  std::vector<std::string> leftOut;
  Eigen::Index places = 0;
  std::vector<std::string> placeNames;  ///< of regions; empty of maps
  std::vector<MapSide> hemispheres;     ///< empty of regions
  std::optional<statistics::PlaceSurface> surface;
  std::vector<bool> mask;           ///< of places that are analysed
  statistics::PersonReader reader;  ///< of `people`
};

/// Reads the lists, finds each person's row and maps, and checks that all maps have as many
/// vertices as the surface.
/// @throws InvalidInput  names the file, the person or the column
[[nodiscard]] Observations readObservations(Context& context, const GlmSettings& settings);

/// Leaves only these people.
void keepPeople(Observations& observations, const std::vector<std::size_t>& rows);

}  // namespace explica::app
