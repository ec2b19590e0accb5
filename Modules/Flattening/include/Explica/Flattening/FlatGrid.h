// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Core/Volume.h"

namespace explica::flattening {

/// A flat map and the sheet of tissue that it shows: the same faces three times.
struct FlatSheet {
  Faces faces;      ///< counter-clockwise in the map
  Positions flat;   ///< V x 3, z = 0, mm
  Positions inner;  ///< V x 3, RAS mm: depth 0
  Positions outer;  ///< V x 3: depth 1; equal to `inner` for a surface without thickness
};

struct FlatGridOptions {
  double cell = 0.5;  ///< mm along u and v
  int depths = 5;     ///< layers from the inner to the outer surface; 1: half way
};

/// Cells of equal size over the map, each with the place in the tissue that it shows.
///
/// The grid's axes are u, v and depth: its first two in millimetres of the map, so that cells are
/// squares of `cell` mm; the third spans the mean distance of inner and outer surface, so that the
/// stack has the tissue's proportions.  Its frame is the map's own, not the scanner's.
/// @return RAS points; NaN where no face of the map is
/// @throws InvalidInput  cell or depths out of range, or more than 2^30 cells
[[nodiscard]] Volume<Eigen::Vector3f> flatGrid(const FlatSheet& sheet,
                                               const FlatGridOptions& options = {});

/// Depth, from 0 to 1, of layer k of a grid with this many.
[[nodiscard]] double depthOfLayer(int k, int depths);

/// The inverse: u, v (mm) and depth (0 to 1) of every voxel of a volume's grid that lies between
/// inner and outer surface; NaN elsewhere.
///
/// Between the surfaces a face sweeps a prism as depth goes from 0 to 1; at one depth it is flat,
/// so that the depth of a point is the root of a cubic, and neighbouring prisms fit together.
[[nodiscard]] Volume<Eigen::Vector3f> flatCoordinates(const FlatSheet& sheet, const Grid& grid);

/// A volume's values at the grid's points, trilinear; NaN off the map or beyond the volume.
/// @param nearest  the nearest voxel's value instead: for labels
[[nodiscard]] Volume<float> resampled(const Volume<float>& volume,
                                      const Volume<Eigen::Vector3f>& points, bool nearest = false);

}  // namespace explica::flattening
