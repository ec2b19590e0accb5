// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/ColourMap.h"
#include "Explica/Report/Picture.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace explica::pipeline {

/// A volume on the grid of a flat map, depth by depth.
struct FlatStack {
  struct Tile {
    double depth = 0;  ///< 0 white, 1 pial
    report::Picture picture;
  };
  std::string name;  ///< of the volume
  double cell = 0;   ///< mm along u and v
  int pixelsPerCell = 1;
  int frames = 1;                            ///< of the volume; the pictures are of their mean
  std::optional<report::ColourScale> scale;  ///< none for labels
  std::vector<Tile> tiles;                   ///< from white to pial, u to the right, v upwards
};

/// Stacks that `explica flatten --volumes` has left in a folder: flat_NAME.nii.gz, by name.
[[nodiscard]] std::vector<std::filesystem::path> flatStackFiles(
    const std::filesystem::path& folder);

/// Pictures of a stack's depths on one scale; labels (`--nearest`) in colours of their own.  Pale
/// blue: off the map, or not known.
/// @throws InvalidInput, IOError  no volume
[[nodiscard]] FlatStack drawFlatStack(const std::filesystem::path& file);

}  // namespace explica::pipeline
