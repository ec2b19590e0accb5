// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Application/Command.h"
#include "Explica/Surface/Summary.h"
#include "Explica/Surface/TissueSheet.h"
#include "Settings.h"

#include <optional>

namespace explica::app {

/// What surfaces are made of.
struct TissueInputs {
  surface::CorticalTissue tissue;             ///< boundaries empty for a sheet
  std::optional<surface::TissueMasks> block;  ///< of a sheet
  Grid grid;
};

[[nodiscard]] TissueInputs readTissue(Context& context, const SurfaceSettings& s);

/// The images that place the borders, where they are given.
struct SurfaceImages {
  std::optional<Volume<float>> first;
  std::optional<Volume<float>> second;  ///< in the frame of the first
  std::optional<double> secondMoved;    ///< mm, farthest, onto the first
};

/// Brings the second image onto the first by a rigid motion.
[[nodiscard]] SurfaceImages readImages(Context& context, const SurfaceSettings& s);

/// Lets go of the images' voxels once the borders are placed.
[[nodiscard]] surface::CorticalSurfaces makeSurfaces(Context& context, const SurfaceSettings& s,
                                                     const TissueInputs& inputs,
                                                     SurfaceImages& images);

/// Tells what of the labels is cut, guessed or not known.
/// @param sheet  which is meant to end at the image's edge, and says which vertices it concerns
void doubtLabels(Context& context, const surface::TissueFacts& tissue, bool sheet);

/// Of human labels: says so where the cerebrum's volume is not a human's.
void checkVolume(Context& context, const surface::CorticalSurfaces& made,
                 const surface::CorticalTissue& tissue, surface::SurfaceSummary& summary);

}  // namespace explica::app
