// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Report/Mosaic.h"

#include <string>
#include <vector>

namespace explica::report {

/// What a page's viewer of slices needs: an image at full resolution, the places to step through,
/// and which shapes of the page's evolutions are cut: the outlines' `part` and `shape`.
///
/// The image is sampled trilinearly on a lattice along the head's axes with the image's least
/// spacing, through the centre of its first voxel: for an image along the axes these are its own
/// voxels.  It reaches 10 mm beyond the outlines.  Above 12 million voxels the lattice is coarser,
/// so that the page stays below 15 MB; `"voxel"` states it.
/// @return a JSON object
/// @throws InvalidInput  no outline with vertices, or a subject of another size than the image
[[nodiscard]] std::string sliceStackJson(const Volume<float>& image,
                                         const std::vector<MosaicOutline>& outlines,
                                         const std::vector<CloseUp>& places,
                                         const MosaicOptions& options = {});

}  // namespace explica::report
