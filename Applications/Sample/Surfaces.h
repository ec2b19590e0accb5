// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/IO/SurfaceFile.h"

#include <filesystem>
#include <optional>
#include <string>

namespace explica::app {

/// The white and pial surface of a hemisphere, with corresponding vertices.
struct Cortex {
  TriangleMesh white, pial;
  std::string structure;
  io::SurfaceOrigin origin;                       ///< of the white surface
  std::optional<Eigen::Matrix4d> scannerFromTkr;  ///< of FreeSurfer's surface RAS, if known
};

/// Where the surfaces are to be taken from.
struct CortexFiles {
  std::optional<std::string> folder, white, pial, hemisphere;
  io::SurfaceReadOptions reading;
};

/// Finds and reads both surfaces: the two files, or those of a folder: `explica surface`'s, a
/// FreeSurfer subject or its `surf`, fMRIPrep's `anat`, the HCP's (`*.L.white.*surf.gii`).
/// @throws UsageError    neither a folder nor both files; L or R is wanted and not given
/// @throws InvalidInput  a folder without them: says what was looked for
[[nodiscard]] Cortex readCortex(Context& context, const CortexFiles& files);

}  // namespace explica::app
