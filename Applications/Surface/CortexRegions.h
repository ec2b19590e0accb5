// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Explica/IO/LabelNames.h"
#include "Explica/IO/VertexDataFile.h"
#include "Settings.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// Labels of regions, on an atlas's voxels or on the vertices of given surfaces.
struct CortexRegions {
  std::optional<Volume<Label>> atlas;
  std::optional<io::LabelMap> parcellation;
  io::LabelNames names;
  io::LabelColours colours;
};

/// @param made  given surfaces, whose vertices a parcellation is of
[[nodiscard]] CortexRegions readRegions(Context& context, const SurfaceSettings& s,
                                        const surface::CorticalSurfaces& made);

/// Writes regions.tsv and regions.label.gii.
/// @return how many there are
std::size_t writeRegions(Context& context, const CortexRegions& regions,
                         const surface::CorticalSurfaces& made, const std::string& structure);

}  // namespace explica::app
