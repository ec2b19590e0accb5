// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Context.h"
#include "Explica/Application/Declaration.h"
#include "Explica/IO/PointTransformFile.h"
#include "Explica/IO/SurfaceFile.h"

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

/// Declares --surfaces, --hemisphere, --white and --pial.
void declareCortex(Declaration& d, CortexFiles& files, const std::string& group);

/// Finds and reads both surfaces: the two files, or those of a folder: `explica surface`'s, a
/// FreeSurfer subject or its `surf`, fMRIPrep's `anat`, the HCP's (`*.L.white.*surf.gii`), a
/// pycortex subject's (`wm_lh.gii`).
/// @throws UsageError    neither a folder nor both files; L or R is wanted and not given
/// @throws InvalidInput  a folder without them: says what was looked for
[[nodiscard]] Cortex readCortex(Context& context, const CortexFiles& files);

/// Where volumes lie that were measured elsewhere than the surface.
struct VolumePlace {
  std::optional<std::string> file;
  io::TransformSense sense = io::TransformSense::Auto;
};

/// Declares --to-volume and --to-volume-sense.
void declarePlace(Declaration& d, VolumePlace& place, const std::string& group);

/// The transform of --to-volume, if it is given.
/// @param cortex  of whose surfaces places are taken; may be null
[[nodiscard]] std::optional<io::PointTransform> transformTo(Context& context, const Grid& volume,
                                                            const VolumePlace& place,
                                                            const Cortex* cortex);

/// Name of a volume's outputs: its file name without endings such as .nii.gz.
[[nodiscard]] std::string stemOf(const std::string& path);

}  // namespace explica::app
