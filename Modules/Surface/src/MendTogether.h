// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>

namespace explica::surface {

/// What must not be left in any of several surfaces that share their faces.
struct MendingLimits {
  double leastArea = 0;    ///< of a face, mm^2
  double longestEdge = 0;  ///< mm
};

/// What mendTogether() did.
struct Mending {
  std::int64_t removed = 0;   ///< vertices taken out of all surfaces
  std::int64_t inserted = 0;  ///< put into all
};

/// Joins the ends of an edge of faces that are too small in one of the surfaces, and puts a vertex
/// into the middle of edges that are too long in one, in all surfaces alike: so vertex i of one
/// still belongs to vertex i of the others.  The number of faces is kept where it can be: further
/// long edges are split, or small faces joined, until as many were put in as taken out.  No step
/// changes the topology of a surface or makes it meet itself; what none mends stays.
/// @param surfaces  closed or with rims, each without self-intersection, the same faces in each
/// @param values    V x any; of a vertex put in: the mean of the ends, 0 (not known) if one is 0
/// @param cell      about the length of an edge, mm
Mending mendTogether(const std::array<TriangleMesh*, 3>& surfaces, Eigen::MatrixXd& values,
                     const MendingLimits& limits, double cell);

}  // namespace explica::surface
