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
              ///< VTK's order, each with a positive Jacobian at all of its corners
  Vector normal = Vector::Zero();  ///< planar tissue: quadrilaterals run counter-clockwise seen
                                   ///< from its tip; its greatest component is positive
  double volume = 0;               ///< of all cells, mm^3; their area, mm^2, of planar tissue
  std::size_t trajectories = 0;
  std::size_t lost = 0;  ///< trajectories that did not reach both boundaries; their cells lack
  std::size_t degenerate = 0;  ///< cells left out because they are flat or turned over at a corner
};

/// Trajectories through the vertices of the surface u = 1/2, cut at the depths 0, 1/levels, ..., 1.
///
/// The surface is meshed by quadrilaterals, one for each link between neighbouring voxel centres
/// that it crosses (in the plane by edges), so that cells are about a voxel wide.  Neighbouring
/// cells share whole faces: the grid is conforming, except where cells are left out (`lost`,
/// `degenerate`) and where a sheet of a buried sulcus lies within a voxel of u = 1/2.  Cells of
/// different sheets of the surface share no vertex.
/// @param levels  layers of cells across the tissue, >= 1
/// @throws InvalidInput  levels < 1
[[nodiscard]] AnatomicalGrid anatomicalGrid(const harmonic::Annulus& annulus,
                                            const harmonic::Interpolant& interpolant, int levels);

}  // namespace explica::correspondence
