// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "CortexRegions.h"
#include "Explica/Application/Command.h"
#include "Explica/Surface/Summary.h"
#include "Settings.h"

#include <optional>
#include <string>
#include <vector>

namespace explica::app {

/// One of the surfaces that are written.
struct WrittenSurface {
  const char* file;
  const char* fsName;
  const char* secondary;
  const char* key;
  const TriangleMesh* mesh;
};

/// @param hasGrey  without it there is the white surface alone
[[nodiscard]] std::vector<WrittenSurface> namedSurfaces(const surface::CorticalSurfaces& made,
                                                        bool hasGrey);

/// Surfaces, maps and regions as GIFTI.
void writeMaps(Context& context, const SurfaceSettings& s, const surface::CorticalSurfaces& made,
               const surface::CorticalTissue& tissue, const std::vector<WrittenSurface>& surfaces,
               const CortexRegions& regions, surface::SurfaceSummary& summary);

/// The same as FreeSurfer's files.
/// @param fsGrid  voxels of the volume whose surface RAS they use; none: scanner RAS
void writeFreeSurfer(Context& context, const SurfaceSettings& s,
                     const surface::CorticalSurfaces& made, const surface::CorticalTissue& tissue,
                     const std::vector<WrittenSurface>& surfaces,
                     const std::optional<Grid>& fsGrid);

/// topology.tsv: a row a corrected defect.
[[nodiscard]] std::string defectTable(const std::vector<surface::Defect>& defects);

}  // namespace explica::app
