// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

#include <vector>

namespace explica::sphere {

/// Radius of the spheres that are written, as FreeSurfer's.
inline constexpr double kSphereRadius = 100;  // mm

/// What makeOneToOne() did.
struct OneToOne {
  std::int64_t turnedBefore = 0, turnedAfter = 0;  ///< faces turned over, exact
  std::vector<std::int32_t> moved;                 ///< vertices, ascending
};

/// Puts the vertices of a spherical mesh at kSphereRadius in single precision, as files hold them,
/// and moves few of them until no face is turned over there.
///
/// A vertex of a face turned over goes to the middle of the places that see all of its neighbours,
/// or, where there is none, of its neighbours; where that does not help, the neighbours move, too.
/// What remains is counted.
OneToOne makeOneToOne(TriangleMesh& sphere);

}  // namespace explica::sphere
