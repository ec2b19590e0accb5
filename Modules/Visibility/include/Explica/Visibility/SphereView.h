// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"
#include "Explica/Visibility/Viewpoints.h"

namespace explica::visibility {

/// Points spread evenly over a sphere, along a spiral of the golden angle, with equal weights.
/// @throws InvalidInput  count < 1, or a radius that is not positive
[[nodiscard]] Viewpoints viewSphere(const Point& centre, double radius, int count);

/// A sphere that encloses the surface: about the middle of its box, with three times the box's
/// diagonal as radius.
[[nodiscard]] Viewpoints enclosingSphere(const TriangleMesh& mesh, int count);

/// What viewpoints all around see of a surface.
struct SphereView {
  /// F x 3: sum over the viewpoints P that see the face's centroid of d, over that of (n . d)+ for
  /// a plane seen from one side; d the unit direction to P, n the outward normal.  About n where
  /// nothing stands in the way, shorter in folds, 0 where no viewpoint sees the face.
  Positions direction;
  Eigen::VectorXd
      share;  ///< F, in [0, 1]: of the flux from viewpoints before the face, what arrives
  Eigen::VectorXd seen;   ///< F: 1 if any viewpoint sees the face's centroid, else 0
  double visibility = 0;  ///< mean of `share` by area: see lookFromSphere()
  double seenShare = 0;   ///< mean of `seen` by area
};

/// Looks at a surface from all viewpoints at once; one ray from each face's centroid.
///
/// `visibility` is the thesis's global visibility carried to space.  Equations 4.6 and 4.7 take
/// away from a viewing circle what each point of a curve cannot see of it; here
///
///   V(S) = integral over x in S, P of H(x, P) (n . d)+  /  integral of (n . d)+,
///
/// d = (P - x) / |P - x|, H = 1 if nothing stands between x and P, else 0: the flux that arrives
/// over what would arrive if nothing stood in the way, as in the flux model (4.8) with the
/// Heaviside function kept.  For a sphere far away it is four times the mean area of the surface's
/// shadows over its own area, so that V = 1 for convex surfaces and for no others (Cauchy).
///
/// @throws InvalidInput  no face, no viewpoint, a position that is not finite
[[nodiscard]] SphereView lookFromSphere(const TriangleMesh& mesh, const Viewpoints& viewpoints);

}  // namespace explica::visibility
