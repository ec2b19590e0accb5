// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Core/Volume.h"
#include "Explica/Planar/Curve.h"
#include "Explica/Shapes/HarmonicAnnulus.h"
#include "Explica/Shapes/ShapeFit.h"

#include <vector>

namespace explica::shapes {

/// u on a grid of `voxels` per side (and axis) that just holds the annulus; 0 within
/// its inner and 1 beyond its outer boundary.
[[nodiscard]] Volume<float> fieldOf(const HarmonicShape& shape, int voxels);

/// The closed curves where u = 1/2, vertices moved onto the level; one for every valid shape.
/// @throws InvalidInput  a shape in space, or one too thin for such a grid
[[nodiscard]] std::vector<planar::Curve> levelCurves(const HarmonicShape& shape, int voxels);

/// The surface where u = 1/2, by marching tetrahedra, closed and outward, vertices moved onto the
/// level.
/// @throws InvalidInput  a shape in the plane, or one too thin for such a grid
[[nodiscard]] TriangleMesh levelSurface(const HarmonicShape& shape, int voxels);

/// Samples of a closed polygon, `count` pieces of equal length.
[[nodiscard]] TargetSamples samplesOf(const planar::Curve& target, int count);

/// Samples of a surface: its faces, of which every k-th is taken so that about `count` are left.
[[nodiscard]] TargetSamples samplesOf(const TriangleMesh& target, int count);

/// Largest and mean distance of a shape's points from a target.
struct LevelDistance {
  double mean = 0;  ///< mm
  double max = 0;   ///< mm
};
[[nodiscard]] LevelDistance distanceBetween(const planar::Curve& shape,
                                            const planar::Curve& target);
[[nodiscard]] LevelDistance distanceBetween(const TriangleMesh& shape, const TriangleMesh& target);

}  // namespace explica::shapes
