// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Geometry/SparseCholesky.h"

namespace explica::inflation {

/// Spreads the directions in which places see their surroundings along the surface: where nothing
/// is seen, as at the bottom of a closed fold, a face takes over what its neighbourhood sees.
///
/// The field v on vertices minimises
///
///   integral of |v - b|^2 + s^2 |grad v|^2  over the surface at rest,
///
/// b the given directions, constant on faces, s the reach: (M + s^2 L) v = sum over faces of A b /
/// 3 with lumped mass M and the cotangent Laplacian L.  A face's direction is that of the mean of v
/// at its corners, of unit length.
class DirectionField {
 public:
  /// @param mesh   the surface at rest
  /// @param reach  s, mm, > 0
  DirectionField(const TriangleMesh& mesh, double reach);

  /// @param directions  F x 3, longer where more is seen
  /// @return F x 3, of unit length; zero where the field vanishes
  [[nodiscard]] Positions spread(const Positions& directions) const;

 private:
  Faces faces_;
  Eigen::VectorXd areas_;
  geometry::SparseCholesky solver_;
};

}  // namespace explica::inflation
