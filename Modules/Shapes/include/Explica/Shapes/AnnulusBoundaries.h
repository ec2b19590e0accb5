// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Volume.h"
#include "Explica/Planar/Contour.h"
#include "Explica/Planar/Curve.h"

#include <vector>

namespace explica::shapes {

/// The two polygons that bound an annulus of the plane, mm.
struct AnnulusBoundaries {
  planar::Curve inner;
  planar::Curve outer;
};

/// Of tissue in a slice of a label image: sub-pixel contours of the `inner` labels, and of these
/// and the `tissue` labels together; of each the largest.  In the slice's plane frame.
/// @throws InvalidInput  slice out of range, labels absent from it
[[nodiscard]] AnnulusBoundaries boundariesOfTissue(const Volume<Label>& labels,
                                                   const std::vector<Label>& inner,
                                                   const std::vector<Label>& tissue, int slice,
                                                   const planar::ContourOptions& options = {});

/// The band about targets: all points within `band` of the region between their intersection and
/// their union.  Of one target, those within `band` of it.
///
/// Details of a shape fade with the distance from a boundary, whatever the shape: a band keeps that
/// distance the same all around.
/// @throws InvalidInput  no target, a band that is not positive, or so wide that the inner boundary
///                       is gone or falls into pieces
[[nodiscard]] AnnulusBoundaries bandAround(const std::vector<planar::Curve>& targets, double band);

}  // namespace explica::shapes
