// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"
#include "Explica/Correspondence/Trajectory.h"

namespace explica::correspondence {

/// A grid that follows the tissue [thesis figure 3.3]: points at equal depths along trajectories.
struct AnatomicalGrid {
  Positions points;           ///< P x 3, RAS mm
  Eigen::VectorXd depth;      ///< P, share of the thickness, 0 inner to 1 outer boundary
  Eigen::VectorXd thickness;  ///< P, mm, of the trajectory through the point
  Eigen::Matrix<std::int32_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>
      cells;  ///< C x 8 hexahedra, or C x 4 quadrilaterals of a planar tissue, in
              ///< VTK's order
  std::size_t trajectories = 0;
  std::size_t lost = 0;  ///< trajectories that did not reach both boundaries; their cells lack
};

/// Trajectories through the corners of the voxel faces that separate u < 1/2 from u >= 1/2 (edges
/// of pixels in the plane), cut at the depths 0, 1/levels, ..., 1.
/// @param levels  layers of cells across the tissue, >= 1
/// @throws InvalidInput  levels < 1
[[nodiscard]] AnatomicalGrid anatomicalGrid(const harmonic::Annulus& annulus,
                                            const harmonic::Interpolant& interpolant, int levels);

}  // namespace explica::correspondence
