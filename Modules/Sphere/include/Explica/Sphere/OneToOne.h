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
/// Vertices of faces turned over are taken out, each merged with the neighbour that leaves the
/// fewest such faces, until there is none, and put back in the reverse order: where they were if
/// their ring is seen from there, else in the middle of the places that see it, which a ring taken
/// out like this always has [Praun2003].  What single precision leaves no room for is counted.
OneToOne makeOneToOne(TriangleMesh& sphere);

}  // namespace explica::sphere
