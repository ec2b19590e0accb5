// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Surface/LevelSet.h"

#include <cstdint>
#include <optional>

namespace explica::surface {

/// Mean curvature at vertices, mm^-1: half the cotangent Laplacian's outward part, averaged over
/// neighbours `smoothing` times.  Negative where the surface bulges (gyri, a sphere: -1/R),
/// positive in sulci, as FreeSurfer has it.
[[nodiscard]] Eigen::VectorXd meanCurvature(const TriangleMesh& mesh, int smoothing = 3);

/// What belongs to a vertex of a quantity known at vertices: its mean over the faces around, linear
/// within each, weighted by the function that falls from 1 at the vertex to 0 at the others (the
/// projection with lumped masses).  The integral over a surface without unknown values stays.
/// @param values  per vertex; 0: not known, which stays, and whose faces have no say
[[nodiscard]] Eigen::VectorXd meanOverSurroundings(const TriangleMesh& mesh,
                                                   const Eigen::VectorXd& values);

/// What tells an even surface from a crumpled one.
struct Evenness {
  double dihedralAbove60 = 0;  ///< share of the edges whose faces' normals are more than 60 degrees
                               ///< apart
  double longestEdge = 0;      ///< mm
  double leastFace = 0;        ///< area, mm^2
  double highestSpike = 0;     ///< farthest that a vertex is from the mean of its neighbours, mm
};

/// @param mesh  closed manifold
[[nodiscard]] Evenness evennessOf(const TriangleMesh& mesh);

/// Radius of the ball that has the volume of so many voxels, mm.
[[nodiscard]] double radiusOfVoxels(std::int64_t count, const Grid& grid);

/// Depth of points below the hull of a tissue, mm, >= 0: the hull is the tissue closed by a ball of
/// `radius` mm; unset: a fifth of the radius of the ball that has the tissue's volume, 10 mm for a
/// human hemisphere.
[[nodiscard]] Eigen::VectorXd depthBelowHull(const LevelSet& tissue, const Positions& points,
                                             std::optional<double> radius = {});

}  // namespace explica::surface
