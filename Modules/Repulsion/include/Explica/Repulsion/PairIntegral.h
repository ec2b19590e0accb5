// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

#include <array>

namespace explica::repulsion {

using Corners = std::array<Point, 3>;

/// Energy of one pair of faces and its derivatives by the corners of both.  A corner that the faces
/// share has its derivative split between them: add both.
struct PairIntegral {
  double value = 0;  ///< integral of 1/|x - y|^2 over S x T, mm^2
  std::array<Vector, 3> byS{Vector::Zero(), Vector::Zero(), Vector::Zero()};  ///< mm
  std::array<Vector, 3> byT{Vector::Zero(), Vector::Zero(), Vector::Zero()};  ///< mm
};

/// How finely a pair is integrated.
enum class PairAccuracy {
  Coarse,    ///< relative error about 1e-3
  Standard,  ///< relative error about 1e-6 for faces that are not needles
  Fine       ///< about 1e-9, for tests
};

/// Integral over two faces that have no corner in common, [Thesis, Eq. 5.40, 5.43]: product Gauss
/// rules, on halves of the larger face until both are small against their distance.  At contact the
/// subdivision ends after a fixed depth, so the value stays finite.
[[nodiscard]] PairIntegral integrateApart(const Corners& s, const Corners& t,
                                          PairAccuracy accuracy = PairAccuracy::Standard);

/// Integral over two faces that share corner 0, [Thesis, Eq. 5.40, 5.44].
///
/// The integrand is homogeneous about the shared corner, so the radial part of Duffy's
/// transformation is done exactly ([Sauter2011, section 5.2]); what is left has no singularity:
///   I = A_S A_T (mean over (edge of S opposite the corner) x T + mean over S x (edge of T)).
[[nodiscard]] PairIntegral integrateVertexSharing(const Corners& s, const Corners& t,
                                                  PairAccuracy accuracy = PairAccuracy::Standard);

/// Integral over two faces that share corners 0 and 1, in the same order.
///
/// Besides the radial part, the integral along the common edge is exact, because the integrand
/// depends on x - y only.  With e, a, b the edge and the third corners seen from corner 0,
///   I = A_S A_T * sum of the means of 1/|z|^2 over the six triangles
///   (a, e, e - b), (a, e - b, a - b), (-b, e - b, a - b), (-b, -e, a - e), (-b, a - e, a - b),
///   (a, a - e, a - b), none of which meets the origin: the values of x - y whose rays fill S - T.
[[nodiscard]] PairIntegral integrateEdgeSharing(const Corners& s, const Corners& t,
                                                PairAccuracy accuracy = PairAccuracy::Standard);

}  // namespace explica::repulsion
