// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <optional>

namespace explica::maps {

/// Mean curvature at vertices, V, mm^-1: half the cotangent Laplacian's outward part, at most one
/// over the square root of the vertex's area, diffused along the surface by `fwhm` mm.  Negative
/// where the surface bulges (gyri, a sphere: -1/R), positive in sulci, as FreeSurfer has it.  At a
/// boundary the mean of the inner neighbours is taken.
/// @param fwhm  unset: a share of the square root of the area, 5 mm for a human hemisphere
[[nodiscard]] Eigen::VectorXd meanCurvature(const TriangleMesh& mesh,
                                            std::optional<double> fwhm = {});

/// Sulcal depth at vertices of a closed surface, V, mm: the signed distance that each travels along
/// the outward normal while the surface is inflated [Fischl1999], positive in sulci, with mean 0
/// over the area.  Inflated by diffusing the coordinates along the surface as it is at the start,
/// a linear flow, for a time in proportion to the area.
[[nodiscard]] Eigen::VectorXd sulcalDepth(const TriangleMesh& mesh);

/// The surface inflated for pictures: its coordinates diffused along it three times as long as for
/// sulcalDepth(), scaled about the centroid to the area that it had.
[[nodiscard]] TriangleMesh inflated(const TriangleMesh& mesh);

}  // namespace explica::maps
