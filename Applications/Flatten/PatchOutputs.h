// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Flattening/Disc.h"
#include "Explica/Flattening/Flatten.h"
#include "Explica/Unfolding/FlatSummary.h"
#include "Subject.h"

#include <optional>
#include <vector>

namespace explica::app {

/// The map on all vertices of the whole, those off the patch at the origin.  A vertex on a cut has
/// the place of its first copy, and faces at second copies are left out.
[[nodiscard]] TriangleMesh wholeMap(const TriangleMesh& reference, const flattening::Disc& disc,
                                    const flattening::FlatPositions& map);

/// The map's positions in space, z = 0.
[[nodiscard]] Positions patchPositions(const flattening::FlatMap& map);

/// Patch and map as GIFTI and as FreeSurfer's patches.
void writeSurfaces(Context& context, const Subject& subject, const flattening::Disc& disc,
                   const flattening::FlatMap& map, const TriangleMesh& flat);

/// Distortion and distance errors, into the summary and distortion.shape.gii.
/// @return area ratio at the patch's vertices
Eigen::VectorXd measure(Context& context, const Subject& subject, const flattening::Disc& disc,
                        const TriangleMesh& flat, unfolding::FlatSummary& summary,
                        Termination& termination);

/// patch.tsv, the regions on the patch, and flat.png.
void writePatchTable(Context& context, const FlattenSettings& s, const Subject& subject,
                     const flattening::Disc& disc, const flattening::FlatMap& map,
                     const Eigen::VectorXd& areaRatio);

/// Writes the states on the way, and says whether they are one-to-one as they are written.
/// @return faces turned over in a frame, at most
std::optional<std::int64_t> writeFrames(Context& context, const Subject& subject,
                                        const flattening::Disc& disc,
                                        const std::vector<flattening::FlatPositions>& frames);

}  // namespace explica::app
