// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <array>

namespace explica::geometry {

using Triangle = std::array<Point, 3>;

/// A point is clearly beside a triangle's plane if |normal . way| exceeds this share of the product
/// of the L1 norms of both edges and of the way: many times the rounding of three products, each of
/// a difference and a component of the normal.
inline constexpr double kBesideRounding = 1e-14;

/// True if two triangles without common vertices share a point; touching counts.  Exact.
[[nodiscard]] bool trianglesIntersect(const Triangle& s, const Triangle& t);

/// True if triangles (p, a, b) and (p, c, d) share a point other than p.  Exact.
[[nodiscard]] bool trianglesSharingVertexIntersect(const Point& p, const Point& a, const Point& b,
                                                   const Point& c, const Point& d);

/// True if triangles (p, q, a) and (q, p, b) share a point off their common edge: they are coplanar
/// and folded onto each other.  Exact.
[[nodiscard]] bool trianglesSharingEdgeIntersect(const Point& p, const Point& q, const Point& a,
                                                 const Point& b);

}  // namespace explica::geometry
