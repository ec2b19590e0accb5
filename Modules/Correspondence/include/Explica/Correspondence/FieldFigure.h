// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Correspondence/AnatomicalGrid.h"
#include "Explica/Correspondence/Correspondence.h"
#include "Explica/Harmonic/Annulus.h"
#include "Explica/Harmonic/Interpolant.h"

#include <optional>
#include <string>

namespace explica::correspondence {

/// The slice (along k) that holds most tissue, of the image's grid.
[[nodiscard]] int fullestSlice(const harmonic::Annulus& annulus);

/// Draws a slice of the tissue as SVG, as figures 3.2 and 3.3 of [Thesis]: (a) the harmonic
/// interpolant u in bands of a tenth, (b) the tangent field T, (c) the trajectories through evenly
/// spread voxels near u = 1/2 with both of their ends, and, if a grid is given, (d) its edges.
///
/// The slice is drawn in its own plane, i to the right and j down.  In space, arrows, trajectories
/// and edges are those of the slice's voxels, projected onto it; of the grid, edges within half a
/// slice.
/// @param slice  along k of the image's grid
/// @return the whole SVG document
/// @throws InvalidInput  no tissue in the slice
[[nodiscard]] std::string drawField(const harmonic::Annulus& annulus,
                                    const harmonic::Interpolant& interpolant,
                                    const Correspondence& correspondence, int slice,
                                    const AnatomicalGrid* grid = nullptr);

}  // namespace explica::correspondence
