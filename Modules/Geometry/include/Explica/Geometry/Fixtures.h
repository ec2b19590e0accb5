// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/TriangleMesh.h"

namespace explica::geometry {

/// Sphere by subdividing an icosahedron `levels` times: 20 * 4^levels faces, vertices on the
/// sphere, faces counter-clockwise from outside.
[[nodiscard]] TriangleMesh makeIcosphere(int levels, double radius = 1.0,
                                         const Point& centre = Point::Zero());

/// A sphere whose radius is modulated by sin waves into folds as deep as `depth` (share of the
/// radius): a small closed stand-in for cortex, without self-intersections.
[[nodiscard]] TriangleMesh makeFoldedSphere(int levels, double radius = 1.0, double depth = 0.25,
                                            int waves = 6);

/// Each face into four; new vertices at edge midpoints, old ones keep their numbers.
[[nodiscard]] TriangleMesh subdivide(const TriangleMesh& mesh);

/// Both as one mesh, without a common vertex; vertices and faces of `a` first.
[[nodiscard]] TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b);

}  // namespace explica::geometry
