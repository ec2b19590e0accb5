// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "Explica/Core/Types.h"

namespace explica::shapes {

/// Angular functions of one direction, in the order of HarmonicShape.
/// @param direction  unit; z is ignored in the plane
void angularBasis(int dimension, int order, const Vector& direction, double* values);

/// Radial factors of degree l at radius r, for u equal to 1 on one boundary and 0 on the other.
struct RadialFactors {
  double inner = 0;
  double outer = 0;
};
[[nodiscard]] RadialFactors radialFactors(int dimension, int degree, double r, double r0,
                                          double r1);

/// Degree of the k-th angular function.
[[nodiscard]] int degreeOf(int dimension, int k);

}  // namespace explica::shapes
